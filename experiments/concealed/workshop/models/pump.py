import torch

from greybox_torch import Balance, GreyBoxModel, Input, Output, Parameter, State

AREA = 0.05  # m^2


class Cascade(GreyBoxModel):
    """Water is pumped into an upper tank, runs into a lower one, and away (Torricelli)."""

    states = [State("upper", "m", initial="measured"), State("lower", "m", initial="measured")]
    inputs = [Input("drive", "1")]
    outputs = [Output("upper", "m"), Output("lower", "m")]
    parameters = [
        Parameter("q", 1.2e-3, unit="m^3/s", lower=0.0),
        Parameter("a1", 9e-4, unit="m^2.5/s", lower=0.0),
        Parameter("a2", 1.0e-3, unit="m^2.5/s", lower=0.0),
    ]
    ports = [Balance("upper_tank", level="upper"), Balance("lower_tank", level="lower")]

    def derivative(self, x, u, p, port):
        down = p.a1 * torch.sqrt(torch.clamp(x.upper, min=1e-4))
        away = p.a2 * torch.sqrt(torch.clamp(x.lower, min=1e-4))
        return {
            "upper": (p.q * u.drive - down + port.upper_tank) / AREA,
            "lower": (down - away + port.lower_tank) / AREA,
        }

    def output(self, x, u, p):
        return {"upper": x.upper, "lower": x.lower}
