"""A mass on a rail of which the position is measured and the speed is not."""

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Sled(GreyBoxModel):
    """m dv/dt = F - c v."""

    states = [State("q", "m", initial="measured"), State("v", "m/s")]
    inputs = [Input("F", "N")]
    outputs = [Output("q", "m")]
    parameters = [
        Parameter("m", 1.0, unit="kg", lower=0.01),
        Parameter("c", 1.0, unit="N s/m", lower=0.0),
    ]
    ports = [Body("sled", speed="v", position="q")]

    def derivative(self, x, u, p, port):
        return {"q": x.v, "v": (u.F - p.c * x.v + port.sled) / p.m}

    def output(self, x, u, p):
        return {"q": x.q}
