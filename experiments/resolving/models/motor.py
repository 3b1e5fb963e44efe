from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Motor(GreyBoxModel):
    """A motor: J dw/dt = k v - b w."""

    states = [State("speed", "rad/s")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [
        Parameter("J", 0.02, unit="kg m^2", lower=1e-5),
        Parameter("k", 0.1, unit="N m/V", lower=0.0, fixed=True),
        Parameter("b", 0.05, unit="N m s/rad", lower=0.0),
    ]
    ports = [Body("rotor", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": (p.k * u.voltage - p.b * x.speed + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"speed": x.speed}
