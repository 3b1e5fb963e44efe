"""What the data say in the place of a law: of a motor whose actuator does nothing below 0.5 V, simulated without the package."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.law_over_data import over_data
from greybox_torch.diagnosis.describe.profiles import with_samples
from greybox_torch.diagnosis.effect import Curve
from greybox_torch.mechanisms.actuator import InputGain, InputLag
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.transmission import Backlash


def change(voltage: np.ndarray) -> np.ndarray:
    """What the dead zone takes from the input, V."""
    return np.sign(voltage) * np.maximum(np.abs(voltage) - 0.5, 0.0) - voltage


@pytest.fixture(scope="module")
def drawn(dead_zone_search):
    """The curve of a law that was fitted to the dead zone's recordings with the motor's own parameters as they are."""

    def draw(law) -> tuple[Curve | None, float]:
        attachment = attach(dead_zone_search.problem.model, "actuator", law)
        fitted = dead_zone_search.refitted([attachment], dead_zone_search.plain)
        curve = over_data(dead_zone_search.study, fitted, attachment, fitted.problem)
        return curve, fitted.fits[0].mean_square

    return draw


def test_the_right_law_lies_within_what_the_data_say(drawn) -> None:
    curve, _ = drawn(ActuatorDeadzone())
    assert curve is not None and curve.free is not None and (curve.unit, curve.force_unit) == ("V", "V")
    free, known = curve.free, np.isfinite(curve.free.force)
    assert known.mean() > 0.95
    away = np.abs(free.force - curve.force)[known]
    assert np.mean(away < 2.0 * free.spread[known]) > 0.85
    assert np.median(free.spread[known]) < 0.05
    assert len(free.at) > 20
    assert np.abs(free.asked - change(free.at)).std() < 0.1


def test_a_wrong_law_does_not(drawn) -> None:
    """A gain in the dead zone's place: the free curve and the points bend away from it, towards what is there."""
    curve, _ = drawn(InputGain())
    assert curve is not None and curve.free is not None
    free, known = curve.free, np.isfinite(curve.free.force)
    away = np.abs(free.force - curve.force)[known]
    assert np.mean(away < 2.0 * free.spread[known]) < 0.6
    bent = np.polynomial.Polynomial.fit(curve.values[known], free.force[known], 3).convert().coef
    assert bent[1] < 0.0 < bent[3]  # it falls within the zone and rises again beyond: no straight line
    assert curve.force == pytest.approx(curve.force[0] * curve.values / curve.values[0])


def test_laws_with_memory_have_none(drawn) -> None:
    assert drawn(InputLag())[0] is None


def test_a_gap_as_a_force(arm_search) -> None:
    """Backlash as the torque that it takes from the gear's cubic spring: K(φ − gap) − K(φ)."""
    state = "+gear_twist"
    gap = attach(arm_search.problem.model, "gear_spring", Backlash(), state)
    fitted = arm_search.refitted([gap], arm_search.plain, [{"gear_spring.backlash.half_gap": 0.01}])
    curve = over_data(arm_search.study, fitted, gap, fitted.problem)
    assert curve is not None and curve.force_unit == "N m" and curve.free is not None
    p = fitted.values()
    acting = np.sign(curve.values) * np.maximum(np.abs(curve.values) - p["gear_spring.backlash.half_gap"], 0.0)

    def spring(twist: np.ndarray) -> np.ndarray:
        return p["k_g1"] * twist + p["k_g3"] * twist**3

    assert curve.force == pytest.approx(
        spring(acting) - spring(curve.values), abs=1e-6 + 1e-3 * np.abs(curve.force).max()
    )


def test_the_signal_is_the_measured_one(begun, motor_data, motor) -> None:
    """Friction over speed: the free curve ends where the records end, and follows the friction that is there."""
    search = begun(motor_data(torque=lambda place, speed: -0.03 * np.tanh(speed / 0.2)), motor)
    friction = attach(search.problem.model, "rotor", CoulombFriction())
    fitted = search.refitted([friction], search.plain)
    curve = over_data(search.study, fitted, friction, fitted.problem)
    assert curve is not None and curve.free is not None
    known = np.isfinite(curve.free.force)
    law = -0.03 * np.tanh(curve.values / 0.2)
    assert np.abs(curve.free.force - law)[known].max() < 0.01
    speeds = search.problem.records.y[0]
    assert curve.values[known][0] == pytest.approx(np.quantile(speeds, 0.002), abs=0.2)
    assert np.abs(np.interp(curve.free.at, curve.values, law) - curve.free.asked).std() < 0.006


def test_where_the_samples_lie_along_a_curve() -> None:
    curve = Curve("stirrer", "rpm", np.linspace(0.0, 600.0, 7), np.zeros(7), "W")
    shown = with_samples(curve, {"stirrer": np.array([0.0, 300.0, 300.0, 600.0, 700.0])})
    assert shown is not None and shown.seen is not None
    assert (len(shown.seen), shown.seen[0], shown.seen[50], shown.seen[99], shown.seen.sum()) == (100, 1, 2, 1, 4)
    assert shown.as_json() == curve.as_json()
    assert with_samples(curve, {}) is curve and with_samples(None, {}) is None
