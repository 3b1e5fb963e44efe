from greybox_torch import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State

LEAD = 0.01 / (2 * 3.141592653589793)  # m per rad


class BallScrew(GreyBoxModel):
    """Servo motor, belt, ball screw and table."""

    states = [
        State("angle", "rad", initial="measured"),
        State("position", "m", initial="measured"),
        State("motor_speed", "rad/s"),
        State("table_speed", "m/s"),
    ]
    inputs = [Input("torque", "N m")]
    outputs = [Output("angle", "rad"), Output("position", "m")]
    parameters = [
        Parameter("J", 4e-4, unit="kg m^2", lower=1e-6),
        Parameter("m", 24.0, unit="kg", lower=0.1, fixed=True),
        Parameter("k", 6e5, unit="N/m", lower=0.0),
        Parameter("d", 600.0, unit="N s/m", lower=0.0),
        Parameter("b", 2e-3, unit="N m s/rad", lower=0.0),
        Parameter("c", 60.0, unit="N s/m", lower=0.0),
    ]
    ports = [
        Body("rotor", speed="motor_speed", position="angle"),
        Body("slide", speed="table_speed", position="position"),
        Coupling(
            "belt",
            deflection=lambda x, u, p: LEAD * x.angle - x.position,
            rate=lambda x, u, p: LEAD * x.motor_speed - x.table_speed,
        ),
    ]

    def derivative(self, x, u, p, port):
        pull = p.k * (LEAD * x.angle - x.position) + p.d * (LEAD * x.motor_speed - x.table_speed) + port.belt
        return {
            "angle": x.motor_speed,
            "position": x.table_speed,
            "motor_speed": (u.torque - p.b * x.motor_speed - LEAD * pull + port.rotor) / p.J,
            "table_speed": (pull - p.c * x.table_speed + port.slide) / p.m,
        }

    def output(self, x, u, p):
        return {"angle": x.angle, "position": x.position}
