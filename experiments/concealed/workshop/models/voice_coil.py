from greybox_torch import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State


class VoiceCoil(GreyBoxModel):
    """A voice coil that moves a mass on a flexure."""

    states = [
        State("current", "A", initial="measured"),
        State("position", "m", initial="measured"),
        State("speed", "m/s"),
    ]
    inputs = [Input("voltage", "V")]
    outputs = [Output("current", "A"), Output("position", "m")]
    parameters = [
        Parameter("L", 1.5e-3, unit="H", lower=1e-6),
        Parameter("R", 2.4, unit="Ohm", lower=0.0),
        Parameter("K", 6.0, unit="N/A", lower=0.0),
        Parameter("m", 0.08, unit="kg", lower=1e-4, fixed=True),
        Parameter("k", 900.0, unit="N/m", lower=0.0),
        Parameter("d", 1.2, unit="N s/m", lower=0.0),
    ]
    ports = [Body("coil", speed="speed", position="position"), Coupling("flexure", deflection="position", rate="speed")]

    def derivative(self, x, u, p, port):
        return {
            "current": (u.voltage - p.R * x.current - p.K * x.speed) / p.L,
            "position": x.speed,
            "speed": (p.K * x.current - p.k * x.position - port.flexure - p.d * x.speed + port.coil) / p.m,
        }

    def output(self, x, u, p):
        return {"current": x.current, "position": x.position}
