"""States that nothing shows are carried from window to window."""

from __future__ import annotations

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.model.unseen_states import unseen_states
from greybox_torch.systems import RobotArm


class Rotor(GreyBoxModel):
    states = [State("angle", "rad"), State("speed", "rad/s")]
    inputs = [Input("current", "A")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("k", 2.0)]
    ports = [Body("rotor", speed="speed", position="angle")]

    def derivative(self, x, u, p, port):
        return {"angle": x.speed, "speed": p.k * u.current - x.speed + port.rotor}

    def output(self, x, u, p):
        return {"speed": x.speed}


class Pendulum(Rotor):
    def derivative(self, x, u, p, port):
        return {"angle": x.speed, "speed": p.k * u.current - x.angle.sin() + port.rotor}


def test_an_angle_that_nothing_depends_on_is_unseen() -> None:
    assert unseen_states(Rotor()) == ("angle",)
    assert Rotor().carried_states() == ("angle",)


def test_an_angle_that_a_force_depends_on_is_not() -> None:
    assert unseen_states(Pendulum()) == ()
    assert unseen_states(RobotArm()) == ()
