import torch

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Pendulum(GreyBoxModel):
    """A pendulum on a motor: J d2q/dt2 = u - c dq/dt - w sin q."""

    states = [State("angle", "rad"), State("speed", "rad/s")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("angle", "rad")]
    parameters = [
        Parameter("J", 0.02, unit="kg m^2", lower=1e-5),
        Parameter("c", 0.05, unit="N m s/rad", lower=0.0),
        Parameter("w", 0.5, unit="N m", lower=0.0),
    ]
    ports = [Body("pivot", speed="speed", position="angle")]

    def derivative(self, x, u, p, port):
        return {
            "angle": x.speed,
            "speed": (u.torque - p.c * x.speed - p.w * torch.sin(x.angle) + port.pivot) / p.J,
        }

    def output(self, x, u, p):
        return {"angle": x.angle}
