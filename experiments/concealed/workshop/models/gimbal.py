import math

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State

DEG = math.pi / 180.0


class Gimbal(GreyBoxModel):
    """A platform on an elastic pivot, turned by the reaction of a wheel; angles in degrees."""

    states = [
        State("angle", "deg", initial="measured"),
        State("rate", "deg/s"),
        State("wheel", "rad/s", initial="measured"),
    ]
    inputs = [Input("torque", "N m")]
    outputs = [Output("angle", "deg"), Output("wheel", "rad/s")]
    parameters = [
        Parameter("J", 0.02, unit="kg m^2", lower=1e-5),
        Parameter("Jw", 4e-4, unit="kg m^2", lower=1e-7, fixed=True),
        Parameter("k", 0.06, unit="N m/rad", lower=0.0),
        Parameter("d", 0.004, unit="N m s/rad", lower=0.0),
        Parameter("b", 2e-5, unit="N m s/rad", lower=0.0),
    ]
    ports = [
        Body("pivot", speed=lambda x, u, p: DEG * x.rate, position=lambda x, u, p: DEG * x.angle),
        Body("bearing", speed=lambda x, u, p: x.wheel - DEG * x.rate),
    ]

    def derivative(self, x, u, p, port):
        turn = DEG * x.rate
        drag = p.b * (x.wheel - turn) - port.bearing
        return {
            "angle": x.rate,
            "rate": (-u.torque + drag - p.k * DEG * x.angle - p.d * turn + port.pivot) / p.J / DEG,
            "wheel": (u.torque - drag) / p.Jw,
        }

    def output(self, x, u, p):
        return {"angle": x.angle, "wheel": x.wheel}
