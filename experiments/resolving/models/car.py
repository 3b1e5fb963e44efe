from greybox_torch import Coupling, GreyBoxModel, Input, Output, Parameter, State


class QuarterCar(GreyBoxModel):
    """A quarter of a car on a road that moves."""

    states = [State("deflection", "m"), State("body_speed", "m/s"), State("tyre", "m"), State("wheel_speed", "m/s")]
    inputs = [Input("road_speed", "m/s")]
    outputs = [Output("deflection", "m")]
    parameters = [
        Parameter("ms", 300.0, unit="kg", lower=1.0, fixed=True),
        Parameter("mu", 40.0, unit="kg", lower=1.0, fixed=True),
        Parameter("ks", 16000.0, unit="N/m", lower=0.0),
        Parameter("cs", 1200.0, unit="N s/m", lower=0.0),
        Parameter("kt", 160000.0, unit="N/m", lower=0.0, fixed=True),
    ]
    ports = [
        Coupling("suspension", deflection="deflection", rate=lambda x, u, p: x.body_speed - x.wheel_speed),
    ]

    def derivative(self, x, u, p, port):
        rate = x.body_speed - x.wheel_speed
        force = p.ks * x.deflection + p.cs * rate + port.suspension
        return {
            "deflection": rate,
            "body_speed": -force / p.ms,
            "tyre": x.wheel_speed - u.road_speed,
            "wheel_speed": (force - p.kt * x.tyre) / p.mu,
        }

    def output(self, x, u, p):
        return {"deflection": x.deflection}
