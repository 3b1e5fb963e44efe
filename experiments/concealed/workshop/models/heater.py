from greybox_torch import Balance, GreyBoxModel, Input, Output, Parameter, State

ROOM = 22.0  # degC


class Barrel(GreyBoxModel):
    """Two heated zones; heat goes from the front to the back and from there to the room."""

    states = [State("front", "degC", initial="measured"), State("back", "degC", initial="measured")]
    inputs = [Input("heat1", "W"), Input("heat2", "W")]
    outputs = [Output("front", "degC"), Output("back", "degC")]
    parameters = [
        Parameter("C1", 900.0, unit="J/K", lower=1.0),
        Parameter("C2", 1200.0, unit="J/K", lower=1.0),
        Parameter("h12", 9.0, unit="W/K", lower=0.0),
        Parameter("h2", 7.0, unit="W/K", lower=0.0),
    ]
    ports = [Balance("front_zone", level="front"), Balance("back_zone", level="back")]

    def derivative(self, x, u, p, port):
        through = p.h12 * (x.front - x.back)
        return {
            "front": (u.heat1 - through + port.front_zone) / p.C1,
            "back": (u.heat2 + through - p.h2 * (x.back - ROOM) + port.back_zone) / p.C2,
        }

    def output(self, x, u, p):
        return {"front": x.front, "back": x.back}
