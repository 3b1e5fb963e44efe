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
    return search, search.refitted((attach(motor, "rotor", Unknown("speed", 8)),), search.plain)


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
        study, begun = found
        wide, was = study.surroundings["rotor"].ranges["speed"], search.surroundings["rotor"].ranges["speed"]
        assert (wide.low, wide.high) == pytest.approx((was.low, was.high), abs=0.05 * was.span)
        assert begun.current is begun.plain is search.plain and begun.found_before is fitted


def test_not_where_noise_alone_is_left_nor_without_a_curve(drawn, motor, monkeypatch) -> None:
    search, fitted = drawn
    narrower = narrow(search, 0.4)
    law = search.refitted((attach(motor, "rotor", QuadraticDrag()),), search.plain)
    assert over_wider_ranges(narrower, SearchState(search.plain, law)) is None
    monkeypatch.setattr(module, "only_noise", lambda *_: True)
    assert over_wider_ranges(narrower, SearchState(search.plain, fitted)) is None
