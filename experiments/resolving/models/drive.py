from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class GearedDrive(GreyBoxModel):
    """A motor that turns a load through an elastic gear."""

    states = [State("motor_speed", "rad/s"), State("twist", "rad"), State("load_speed", "rad/s")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("motor_speed", "rad/s")]
    parameters = [
        Parameter("Jm", 0.01, unit="kg m^2", lower=1e-5),
        Parameter("Jl", 0.02, unit="kg m^2", lower=1e-5),
        Parameter("k", 20.0, unit="N m/rad", lower=0.0, fixed=True),
        Parameter("d", 0.05, unit="N m s/rad", lower=0.0, fixed=True),
        Parameter("b", 0.04, unit="N m s/rad", lower=0.0),
    ]
    ports = [Body("motor", speed="motor_speed"), Body("load", speed="load_speed")]

    def derivative(self, x, u, p, port):
        rate = x.motor_speed - x.load_speed
        gear = p.k * x.twist + p.d * rate
        return {
            "motor_speed": (u.torque - p.b * x.motor_speed - gear + port.motor) / p.Jm,
            "twist": rate,
            "load_speed": (gear + port.load) / p.Jl,
        }

    def output(self, x, u, p):
        return {"motor_speed": x.motor_speed}
