from greybox_torch import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State

RADIUS, MASS, G = 0.1, 80.0, 9.81


class Winch(GreyBoxModel):
    """A drum, a rope, a hanging load of 80 kg."""

    states = [
        State("angle", "rad", initial="measured"),
        State("height", "m", initial=-0.026),
        State("drum_speed", "rad/s"),
        State("load_speed", "m/s"),
    ]
    inputs = [Input("torque", "N m")]
    outputs = [Output("angle", "rad"), Output("force", "N")]
    parameters = [
        Parameter("J", 1.5, unit="kg m^2", lower=0.01),
        Parameter("k", 3e4, unit="N/m", lower=0.0),
        Parameter("d", 150.0, unit="N s/m", lower=0.0),
        Parameter("b", 4.0, unit="N m s/rad", lower=0.0),
        Parameter("c", 10.0, unit="N s/m", lower=0.0),
    ]
    ports = [
        Body("drum", speed="drum_speed", position="angle"),
        Body("load", speed="load_speed", position="height"),
        Coupling(
            "rope",
            deflection=lambda x, u, p: RADIUS * x.angle - x.height,
            rate=lambda x, u, p: RADIUS * x.drum_speed - x.load_speed,
        ),
    ]

    def _strand(self, x, p):
        return p.k * (RADIUS * x.angle - x.height) + p.d * (RADIUS * x.drum_speed - x.load_speed)

    def derivative(self, x, u, p, port):
        pull = self._strand(x, p) + port.rope
        return {
            "angle": x.drum_speed,
            "height": x.load_speed,
            "drum_speed": (u.torque - p.b * x.drum_speed - RADIUS * pull + port.drum) / p.J,
            "load_speed": (pull - MASS * G - p.c * x.load_speed + port.load) / MASS,
        }

    def output(self, x, u, p):
        return {"angle": x.angle, "force": self._strand(x, p)}
