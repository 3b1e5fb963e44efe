"""A ripple of several orders is one law: harmonics of an order that it may not have itself."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple

ORDERS_TWO_AND_THREE = {"order": 1.0, "a": 1e-5, "b": 0.0, "a_2": 0.05, "b_2": 0.11, "a_3": 0.04, "b_3": 0.02}


@pytest.fixture
def turns(around: Surroundings) -> Surroundings:
    """Many turns of a shaft."""
    return replace(
        around, ranges={**around.ranges, "position": Range(0.0, 200.0, 60.0)}, units={**around.units, "position": "rad"}
    )


def test_the_order_that_is_missing_says_nothing(turns: Surroundings) -> None:
    """Seen: a needle bar, of order 2 and 3, told as a ripple and friction over the position (0.97) beside it."""
    ripple = TorqueRipple(1.0, harmonics=3)
    assert ripple.misplaced(turns, ORDERS_TWO_AND_THREE) is None
    weight = {**ORDERS_TWO_AND_THREE, "a": 0.3}
    assert "once per turn is what weight does" in (ripple.misplaced(turns, weight) or "")


def test_it_is_asked_as_harmonics_of_half_the_order_found(turns: Surroundings) -> None:
    forms = [(form, start) for form, start in TorqueRipple(2.0).richer({"a": 0.05, "b": 0.11, "order": 2.0})]
    bases = {start["order"]: {n: v for n, v in start.items() if v and n != "order"} for _, start in forms}
    assert bases[1.0] == {"a_2": 0.05, "b_2": 0.11}
    assert all(
        form.misplaced(turns, dict.fromkeys((p.name for p in form.parameters(turns)), 0.0) | start) is None
        for form, start in forms
    )
