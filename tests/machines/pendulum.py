"""A pendulum model as a user would write it for the recordings of ../shared/recordings/simple_pendulum."""

import torch

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Pendulum(GreyBoxModel):
    """I d²θ/dt² = τ + τ_0 − m g l sin θ − b dθ/dt − F_c tanh(dθ/dt / v_0), with θ = 0 hanging."""

    states = [
        State("position", "rad", initial="measured", description="angle from hanging"),
        State("velocity", "rad/s", initial="measured", description="angular velocity"),
    ]
    inputs = [Input("torque", "N m", description="motor torque")]
    outputs = [Output("position", "rad"), Output("velocity", "rad/s")]
    parameters = [
        Parameter("inertia", 0.1365, unit="kg m^2", lower=1e-3, description="moment of inertia m l²"),
        Parameter("weight", 2.678, unit="N m", lower=0.0, description="gravity torque m g l when horizontal"),
        Parameter("viscous", 0.0471, unit="N m s/rad", lower=0.0, description="viscous friction"),
        Parameter("coulomb", 0.1839, unit="N m", lower=0.0, description="Coulomb friction"),
        Parameter("offset", -0.0759, unit="N m", description="torque offset"),
        Parameter("v_0", 0.05, unit="rad/s", lower=1e-3, fixed=True, description="speed over which friction turns"),
    ]
    ports = [Body("arm", speed="velocity", position="position")]

    def derivative(self, x, u, p, port):
        friction = p.viscous * x.velocity + p.coulomb * torch.tanh(x.velocity / p.v_0)
        torque = u.torque + p.offset - p.weight * torch.sin(x.position) - friction + port.arm
        return {"position": x.velocity, "velocity": torque / p.inertia}

    def output(self, x, u, p):
        return {"position": x.position, "velocity": x.velocity}
