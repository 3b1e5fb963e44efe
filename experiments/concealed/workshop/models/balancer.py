import torch

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Balancer(GreyBoxModel):
    """A boom that stands upright on its motor."""

    states = [State("tilt", "rad", initial="measured"), State("rate", "rad/s")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("tilt", "rad")]
    parameters = [
        Parameter("J", 1.2, unit="kg m^2", lower=0.01),
        Parameter("mgl", 35.0, unit="N m", lower=0.0, fixed=True),
        Parameter("b", 0.8, unit="N m s/rad", lower=0.0),
    ]
    ports = [Body("joint", speed="rate", position="tilt")]

    def derivative(self, x, u, p, port):
        return {"tilt": x.rate, "rate": (p.mgl * torch.sin(x.tilt) - p.b * x.rate + u.torque + port.joint) / p.J}

    def output(self, x, u, p):
        return {"tilt": x.tilt}
