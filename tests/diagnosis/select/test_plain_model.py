"""Where a search begins from a card that cannot be simulated."""

from __future__ import annotations

from typing import Any

import pytest

import greybox_torch as gt
from greybox_torch.diagnosis.select import plain_model
from greybox_torch.errors import NumericalError


def turned(lower: float) -> gt.GreyBoxModel:
    """(J − J_0) dw/dt = 0.1 u − b w with J 0.0002 below J_0: it falls out of all numbers within a few samples."""

    class Turned(gt.GreyBoxModel):
        states = [gt.State("speed", "rad/s", initial="measured")]
        inputs, outputs = [gt.Input("voltage", "V")], [gt.Output("speed", "rad/s")]
        parameters = [
            gt.Parameter("J", 0.0148, unit="kg m^2", lower=lower, upper=0.0149 if lower > 0.01 else float("inf")),
            gt.Parameter("b", 0.05, unit="N m s/rad", lower=0.0, fixed=True),
        ]
        ports = [gt.Body("rotor", speed="speed")]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"speed": (0.1 * u.voltage - p.b * x.speed + port.rotor) / (p.J - 0.015)}

        def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
            return {"speed": x.speed}

    return Turned()


@pytest.fixture(autouse=True)
def motion_says_nothing(monkeypatch) -> None:
    """As where outputs do not show all states: they would tell where to begin."""
    monkeypatch.setattr(plain_model, "views_of", lambda problem, motion: "nothing is seen")


def test_a_card_that_cannot_be_simulated_is_left_for_one_parameter_halved_or_doubled(motor_data, begun) -> None:
    """Seen: a rotary pendulum, whose card has a mass matrix that is not positive."""
    found = begun(motor_data(), turned(1e-4))
    assert found.plain.values()["J"] == pytest.approx(0.035, rel=0.02)


def test_where_none_of_these_can_be_simulated_the_message_says_so(motor_data, begun) -> None:
    with pytest.raises(NumericalError, match="overflows even over windows"):
        begun(motor_data(), turned(0.0147))
