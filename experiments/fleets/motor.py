"""The model of the simulated fleet: a motor under torque control, of which the speed is measured."""

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Motor(GreyBoxModel):
    """J dw/dt = torque - b w."""

    states = [State("speed", "rad/s", initial="measured")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("speed", "rad/s")]
    parameters = [
        Parameter("J", 0.02, unit="kg m^2", lower=0.0, fixed=True, description="inertia, weighed"),
        Parameter("b", 0.05, unit="N m s/rad", lower=0.0, description="viscous friction"),
    ]
    ports = [Body("rotor", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": (u.torque - p.b * x.speed + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"speed": x.speed}
