"""A search begins anew where a curve's signal moves beyond the range that the curve was drawn over."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.select import wider_ranges as module
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.select.wider_ranges import over_wider_ranges
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import QuadraticDrag
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.mechanisms.unknown import Unknown


@pytest.fixture(scope="module")
def drawn(motor_data, motor, begun):
    """A motor with a drag, and a curve of the rotor's speed."""
    search = begun(motor_data(torque=lambda q, v: -0.004 * v * abs(v)), motor)
    curve = attach(motor, "rotor", Unknown("speed", 14))
    falling = {f"{curve.prefix}.w_{k}": 0.002 * (6.5 - k) for k in range(14)}
    return search, search.refitted((curve,), search.plain, [search.plain.values() | falling])


def narrow(search, share: float):
    """The study as if the rotor had been as slow as a ``share`` of its speeds."""
    around = search.surroundings["rotor"]
    speed = around.ranges["speed"]
    slow = Range(share * speed.low, share * speed.high, share * speed.rms)
    slower = replace(around, ranges={**around.ranges, "speed": slow})
    return replace(search.study, surroundings={**search.surroundings, "rotor": slower})


@pytest.mark.parametrize(("share", "anew"), [(0.4, True), (0.95, False)])
def test_over_the_range_that_the_signal_has_with_the_curve(drawn, monkeypatch, share, anew) -> None:
    """Seen: a foot that its pad held in the model as it stands: its curve was level beyond, and a stiffness told beside it (0.97)."""
    monkeypatch.setattr(module, "only_noise", lambda *_: False)
    search, fitted = drawn
    state = SearchState(search.plain, fitted)
    found = over_wider_ranges(narrow(search, share), state)
    assert (found is not None) is anew
    if found is not None:
        study, over = found
        wide, was = study.surroundings["rotor"].ranges["speed"], search.surroundings["rotor"].ranges["speed"]
        assert (wide.low, wide.high) == pytest.approx((was.low, was.high), abs=0.05 * was.span)
        assert over.plain is search.plain and over.prefixes == state.prefixes and over.compared_without
        assert over.current.score < search.plain.score - 0.5


def test_not_where_as_much_as_a_finding_is_left_over_them(drawn, monkeypatch) -> None:
    """Seen: two tanks, where what was found beside the upper one's curve over wider ranges did not last."""
    monkeypatch.setattr(module, "only_noise", lambda *_: False)
    monkeypatch.setattr(module, "with_same_effects", lambda study, begun, before: begun)
    search, fitted = drawn
    assert over_wider_ranges(narrow(search, 0.4), SearchState(search.plain, fitted)) is None


def test_not_where_noise_alone_is_left_nor_without_a_curve(drawn, motor, monkeypatch) -> None:
    search, fitted = drawn
    narrower = narrow(search, 0.4)
    law = search.refitted((attach(motor, "rotor", QuadraticDrag()),), search.plain)
    assert over_wider_ranges(narrower, SearchState(search.plain, law)) is None
    monkeypatch.setattr(module, "only_noise", lambda *_: True)
    assert over_wider_ranges(narrower, SearchState(search.plain, fitted)) is None
