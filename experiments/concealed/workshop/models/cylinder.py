from greybox_torch import Balance, Body, GreyBoxModel, Input, Output, Parameter, State

AREA = 1.2e-3  # m^2


class Cylinder(GreyBoxModel):
    """Hydraulic cylinder: the valve's flow builds the load pressure, the pressure moves a mass."""

    states = [
        State("pressure", "bar", initial="measured"),
        State("position", "mm", initial="measured"),
        State("speed", "m/s"),
    ]
    inputs = [Input("valve", "V")]
    outputs = [Output("pressure", "bar"), Output("position", "mm")]
    parameters = [
        Parameter("C", 0.05, unit="1e-4 m^3/bar", lower=1e-4),
        Parameter("Kq", 9e-5, unit="m^3/(s V)", lower=0.0),
        Parameter("Kc", 1.2e-6, unit="m^3/(s bar)", lower=0.0),
        Parameter("m", 150.0, unit="kg", lower=1.0, fixed=True),
        Parameter("b", 1500.0, unit="N s/m", lower=0.0),
    ]
    ports = [
        Balance("oil", level="pressure"),
        Body("piston", speed="speed", position=lambda x, u, p: 1e-3 * x.position),
    ]

    def derivative(self, x, u, p, port):
        flow = p.Kq * u.valve - p.Kc * x.pressure - AREA * x.speed + port.oil
        return {
            "pressure": flow / (1e-4 * p.C),
            "position": 1e3 * x.speed,
            "speed": (AREA * 1e5 * x.pressure - p.b * x.speed + port.piston) / p.m,
        }

    def output(self, x, u, p):
        return {"pressure": x.pressure, "position": x.position}
