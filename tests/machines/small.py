"""Small machines of different kinds, for diagnoses of random records."""

from greybox_torch import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, State


class Rotor(GreyBoxModel):
    """J dw/dt = k v - b w, speed measured."""

    states = [State("speed", "rad/s")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [
        Parameter("J", 0.02, unit="kg m^2", lower=0.0),
        Parameter("k", 0.10, unit="N m/V", lower=0.0, fixed=True),
        Parameter("b", 0.05, unit="N m s/rad", lower=0.0),
    ]
    ports = [Body("rotor", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": (p.k * u.voltage - p.b * x.speed + port.rotor) / p.J}

    def output(self, x, u, p):
        return {"speed": x.speed}


class Slide(GreyBoxModel):
    """m dv/dt = F - k s - d v with the position s measured and the speed v not."""

    states = [State("position", "m", initial="measured"), State("speed", "m/s")]
    inputs = [Input("force", "N")]
    outputs = [Output("position", "m")]
    parameters = [
        Parameter("m", 1.0, unit="kg", lower=0.0, fixed=True),
        Parameter("k", 25.0, unit="N/m", lower=0.0),
        Parameter("d", 2.0, unit="N s/m", lower=0.0),
    ]
    ports = [Body("slide", speed="speed", position="position"), Coupling("spring", deflection="position", rate="speed")]

    def derivative(self, x, u, p, port):
        force = u.force - p.k * x.position - p.d * x.speed + port.slide - port.spring
        return {"position": x.speed, "speed": force / p.m}

    def output(self, x, u, p):
        return {"position": x.position}


class Tank(GreyBoxModel):
    """A dh/dt = q - c h, level measured."""

    states = [State("level", "m", initial="measured")]
    inputs = [Input("inflow", "m^3/s")]
    outputs = [Output("level", "m")]
    parameters = [
        Parameter("A", 0.5, unit="m^2", lower=0.0, fixed=True),
        Parameter("c", 0.4, unit="m^2/s", lower=0.0, upper=10.0),
    ]
    ports = [Balance("tank", level="level")]

    def derivative(self, x, u, p, port):
        return {"level": (u.inflow - p.c * x.level + port.tank) / p.A}

    def output(self, x, u, p):
        return {"level": x.level}


class Cart(GreyBoxModel):
    """A cart with a measured slope of its rail, position and speed measured."""

    states = [State("position", "m", initial="measured"), State("speed", "m/s", initial="measured")]
    inputs = [Input("force", "N"), Input("slope", "rad")]
    outputs = [Output("position", "m"), Output("speed", "m/s")]
    parameters = [
        Parameter("m", 2.0, unit="kg", lower=0.0),
        Parameter("d", 3.0, unit="N s/m", lower=0.0),
        Parameter("g", 9.81, unit="m/s^2", fixed=True),
    ]
    ports = [Body("cart", speed="speed", position="position")]

    def derivative(self, x, u, p, port):
        force = u.force - p.d * x.speed - p.m * p.g * u.slope + port.cart
        return {"position": x.speed, "speed": force / p.m}

    def output(self, x, u, p):
        return {"position": x.position, "speed": x.speed}


class WarmRotor(GreyBoxModel):
    """The rotor with a temperature that no output shows."""

    states = [State("speed", "rad/s"), State("warmth", "K", initial=1.0)]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [
        Parameter("J", 0.02, unit="kg m^2", lower=0.0),
        Parameter("k", 0.10, unit="N m/V", lower=0.0, fixed=True),
        Parameter("b", 0.05, unit="N m s/rad", lower=0.0),
    ]
    ports = [Body("rotor", speed="speed")]

    def derivative(self, x, u, p, port):
        return {
            "speed": (p.k * u.voltage - p.b * x.speed + port.rotor) / p.J,
            "warmth": 0.01 * p.b * x.speed * x.speed - 0.2 * x.warmth,
        }

    def output(self, x, u, p):
        return {"speed": x.speed}
