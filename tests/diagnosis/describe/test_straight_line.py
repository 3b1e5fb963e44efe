"""Curves that are straight lines, as equations."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.straight_line import straight_line
from greybox_torch.diagnosis.effect import Curve
from greybox_torch.diagnosis.factor import Factor
from greybox_torch.model import Actuator, Balance

ROOM, SUN = Balance("room", level="air"), np.linspace(0.0, 600.0, 61)
RNG = np.random.default_rng(3)


def curve(force: np.ndarray, seen: np.ndarray | None = None, factor: Factor | None = None) -> Curve:
    return Curve("level", "W/m^2", SUN, force, "W", seen=seen, factor=factor)


@pytest.mark.parametrize(
    ("force", "expected"),
    [
        (1.8 * SUN + 10.0 * RNG.normal(size=61), "port.room += 1.8 * sun"),
        (-0.25 * SUN + 90.0, "port.room += -0.25 * sun + 90"),
        (0.25 * SUN - 90.0, "port.room += 0.25 * sun - 90"),
        (0.003 * SUN**2, ""),
        (np.zeros(61), ""),
        (100.0 * RNG.normal(size=61), ""),
    ],
)
def test_a_line_and_what_is_none(force: np.ndarray, expected: str) -> None:
    assert straight_line(curve(force), ROOM, "sun") == expected


def test_only_what_the_records_visit_counts() -> None:
    """The last height, which few samples determine, is far off; where all are visited alike it is no straight line."""
    force = 2.0 * SUN
    force[-6:] += 400.0
    rarely = np.r_[np.full(9, 1000), 1]
    assert straight_line(curve(force, rarely), ROOM, "sun") == "port.room += 2 * sun"
    assert straight_line(curve(force), ROOM, "sun") == ""


def test_a_curve_that_is_the_same_everywhere_is_its_factor() -> None:
    factor = Factor("sun", "W/m^2", 200.0)
    flat = 360.0 + 5.0 * RNG.normal(size=61)
    assert straight_line(curve(flat, factor=factor), ROOM, "air") == f"port.room += {flat.mean() / 200:.3g} * sun"
    assert straight_line(curve(360.0 + 1.0 * SUN, factor=factor), ROOM, "air") == ""


def test_at_an_actuator_there_is_no_such_equation() -> None:
    assert straight_line(curve(2.0 * SUN), Actuator("actuator", "torque"), "torque") == ""


@pytest.mark.parametrize("name", ["air - wall", "d air/dt", "direction of speed", "angle within a turn"])
def test_a_signal_that_the_model_has_no_name_for_is_no_equation(name: str) -> None:
    assert straight_line(curve(2.0 * SUN), ROOM, name) == ""
    assert straight_line(curve(np.full(61, 360.0), factor=Factor(name, "", 200.0)), ROOM, "air") == ""


def test_through_two_places_there_is_always_a_line() -> None:
    assert straight_line(curve(2.0 * SUN, np.r_[500, np.zeros(8, int), 500]), ROOM, "sun") == ""
