"""An order over a travel is in radians per metre, and has a pitch; over an angle it counts periods per turn."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.api.verdict_summary import effect_table
from greybox_torch.mechanisms.pitch import order_told, pitch_of, with_pitch
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.report.sections.effects import Effects
from tests.diagnosis.test_verdict import BACKLASH, verdict


@pytest.mark.parametrize(
    ("position", "unit", "told"),
    [
        ("m", "rad/m", "radians per travel: 2 pi over the pitch"),
        ("rad", "", "periods per turn"),
        ("", "", "periods per turn"),
    ],
)
def test_the_unit_of_an_order_is_that_of_its_position(position: str, unit: str, told: str) -> None:
    """Seen: a linear motor's order of 209.73 without a unit, called "periods per turn"."""
    around = Surroundings({"position": Range(0.0, 1.0, 0.5)}, {"position": position}, "N", 1e-3)
    order = next(p for p in TorqueRipple(209.73).parameters(around) if p.name == "order")
    assert (order.unit, order.description) == (unit, told) == order_told(position)


def test_the_pitch_is_what_a_drawing_of_the_motor_has() -> None:
    pitch = pitch_of(209.73, "rad/m", 0.079)
    assert pitch is not None
    value, deviation, unit = pitch
    assert (round(value, 2), unit) == (29.96, "mm") and deviation == pytest.approx(29.96 * 0.079 / 209.73, rel=1e-3)
    assert pitch_of(6.0, "") is None and pitch_of(0.0, "rad/m") is None
    assert pitch_of(2.0, "rad/mm") == (pytest.approx(3.1416, rel=1e-4), None, "mm")
    assert with_pitch(order_told("m")[1], 209.73, "rad/m").endswith("over the pitch, here 29.96 mm")
    assert with_pitch("gain", 2.0, "rad/V") == "gain"


def test_console_and_report_tell_the_pitch() -> None:
    entry = {"value": 209.73, "std": 0.079, "unit": "rad/m", "description": order_told("m")[1]}
    found = verdict(replace(BACKLASH, mechanism="torque_ripple", port="carriage", parameters={"order": entry}))
    first, second = effect_table(found)[1]
    assert first[4:6] == ["order", 209.73] and second[4] == "(pitch)" and second[7] == "mm"
    card = Effects.of(found)
    assert card is not None
    assert [row.value for row in card.cards[0].parameters] == ["209.730 ± 0.079", "29.958 ± 0.011"]
