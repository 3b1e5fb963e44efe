"""Which laws could have drawn a learned curve."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.matching import (
    LEAST_MATCH,
    MOST_LAWS,
    kinematic_laws,
    law_force,
    matching_laws,
    worth_a_refit,
)
from greybox_torch.mechanisms.mechanism import Range, Surroundings

AROUND = Surroundings(
    {name: Range(-5.0, 5.0, 2.5) for name in ("speed", "load", "position", "deflection", "rate")},
    {"speed": "rad/s", "position": "rad", "deflection": "rad", "rate": "rad/s"},
    "N m",
    0.01,
)
SPEED = torch.linspace(-5, 5, 201, dtype=torch.float64)
EVENLY = np.ones(201)


@pytest.mark.parametrize(
    ("name", "values"),
    [("quadratic_drag", {"c": 0.3}), ("viscous_friction", {"c": 0.2}), ("constant_bias", {"bias": -0.4})],
)
def test_the_law_that_drew_the_curve_matches_it(name: str, values: dict[str, float]) -> None:
    force = law_force(LIBRARY[name](), AROUND, {"speed": SPEED}, values)
    found = {m.law.name: m for m in matching_laws("body", AROUND, {"speed": SPEED}, force, EVENLY)}
    assert found[name].share == pytest.approx(1.0, abs=1e-9)
    assert {n: found[name].values[n] for n in values} == pytest.approx(values)
    assert max(m.share for m in found.values()) <= 1.0 + 1e-12


@pytest.mark.parametrize("name", ["torque_saturation", "actuator_deadzone"])
def test_a_limit_or_a_dead_band_that_differs_by_direction_is_asked_in_that_form(name: str) -> None:
    law = LIBRARY[name](by_direction=True)
    around = Surroundings({"input": Range(-5.0, 5.0, 2.5)}, {"input": "V"}, "V", 0.01)
    values = {"limit": 2.0, "softness": 0.05, "half_width": 1.0, "asymmetry": 0.3}
    own = {p.name: values[p.name] for p in law.parameters(around)}
    change = law_force(law, around, {"input": SPEED}, own)
    found = {m.law.name: m for m in matching_laws("actuator", around, {"input": SPEED}, change, EVENLY)}
    assert found[name].law.options()["by_direction"] and found[name].share > LEAST_MATCH


def test_best_first_and_few_of_them() -> None:
    force = law_force(LIBRARY["quadratic_drag"](), AROUND, {"speed": SPEED}, {"c": 0.3})
    matches = matching_laws("body", AROUND, {"speed": SPEED}, force, EVENLY)
    assert [m.share for m in matches] == sorted((m.share for m in matches), reverse=True)
    assert len({m.law.name for m in matches}) == len(matches)
    few = worth_a_refit(matches)
    assert few == matches[: len(few)] and 0 < len(few) <= MOST_LAWS
    assert all(m.share > LEAST_MATCH for m in few)


def test_laws_that_need_more_are_left_out() -> None:
    """Laws of other signals, laws with memory, laws that are there already, and laws of other ports."""
    force = -np.abs(np.linspace(-3, 3, 201)) * np.tanh(10 * SPEED.numpy())
    alone = {m.law.name for m in matching_laws("body", AROUND, {"speed": SPEED}, force, EVENLY, {"quadratic_drag"})}
    both = {"speed": SPEED, "load": torch.linspace(-3, 3, 201, dtype=torch.float64)}
    loaded = matching_laws("body", AROUND, both, force, EVENLY)
    assert not alone & {"load_dependent_friction", "presliding_hysteresis", "quadratic_drag", "nonlinear_stiffness"}
    assert loaded[0].law.name == "load_dependent_friction" and loaded[0].share > 0.95


def test_a_size_of_the_wrong_sign_is_none() -> None:
    """A force that drives is no friction: the coefficient stays at zero, and nothing is matched."""
    driving = 0.2 * SPEED.numpy()
    found = {m.law.name: m for m in matching_laws("body", AROUND, {"speed": SPEED}, driving, EVENLY)}
    assert found["quadratic_drag"].values["c"] == 0.0 and found["quadratic_drag"].share == pytest.approx(0.0)


def test_weights_count() -> None:
    force = np.where(SPEED.numpy() > 0, 1.0, -3.0)
    right = np.where(SPEED.numpy() > 0, 1.0, 0.0)
    found = {m.law.name: m for m in matching_laws("body", AROUND, {"speed": SPEED}, force, right)}
    assert found["constant_bias"].values["bias"] == pytest.approx(1.0)
    assert found["constant_bias"].share == pytest.approx(1.0)


def test_a_force_beside_is_left_out_of_the_comparison() -> None:
    """A curve of drag and of something else is drag alone where that something may act in any amount."""
    other = np.sqrt(np.abs(SPEED.numpy()) + 1.0)[:, None]
    force = law_force(LIBRARY["quadratic_drag"](), AROUND, {"speed": SPEED}, {"c": 0.3}) + 8.0 * other[:, 0]
    shares = [
        {m.law.name: m for m in matching_laws("body", AROUND, {"speed": SPEED}, force, EVENLY, beside=beside)}
        for beside in (None, other)
    ]
    alone, beside = (found["quadratic_drag"] for found in shares)
    assert alone.share < LEAST_MATCH and beside.share == pytest.approx(1.0)
    assert beside.values["c"] == pytest.approx(0.3)


def test_a_part_of_a_law_that_acts_beside_has_no_size() -> None:
    """Seen: Stribeck friction with c = 9.2e9 N/(m/s) beside the model's own b_v, whose simulation overflowed: it was the true law."""
    values = {"F_c": 0.8, "F_s": 0.4, "v_s": 0.5, "v_0": 0.05}
    force = law_force(LIBRARY["stribeck_friction"](), AROUND, {"speed": SPEED}, values)
    speed = SPEED.numpy()[:, None] * (1.0 + 1e-10 * np.sin(np.arange(201.0)))[:, None]  # but for rounding
    found = {m.law.name: m for m in matching_laws("body", AROUND, {"speed": SPEED}, force, EVENLY, beside=speed)}
    best = found["stribeck_friction"]
    assert best.values["c"] == 0.0 and 0.7 < best.values["F_c"] < 0.9 and best.share > 0.99


def test_of_rounding_no_law_matches_a_share() -> None:
    """Where what acts beside can be all of the force, nothing is left for a law."""
    force = np.exp(SPEED.numpy() / 3.0)
    found = matching_laws("body", AROUND, {"speed": SPEED}, force, EVENLY, beside=force[:, None])
    assert found and all(match.share == 0.0 for match in found)


def test_kinematic_laws() -> None:
    found = {law.name: sizes for law, sizes in kinematic_laws(AROUND, {"deflection", "rate"})}
    assert list(found) == ["backlash"]
    assert len(found["backlash"]) == 4 and all(0 < values["half_gap"] < 5.0 for values in found["backlash"])


INPUT = torch.linspace(-5, 5, 201, dtype=torch.float64)
AT_DRIVE = Surroundings({"input": Range(-5.0, 5.0, 2.5)}, {"input": "V"}, "V", 0.01)


@pytest.mark.parametrize("gain", [1.0, 1.3])
@pytest.mark.parametrize(
    ("name", "values"),
    [("torque_saturation", {"limit": 2.2}), ("actuator_deadzone", {"half_width": 0.7})],
)
def test_flat_ends_are_saturation_and_a_flat_middle_is_a_dead_band(
    name: str, values: dict[str, float], gain: float
) -> None:
    """Also where the gain of the model has taken a part of it upon itself, and with the ripple of a learned curve."""
    u = INPUT.numpy()
    acting = u + law_force(LIBRARY[name](), AT_DRIVE, {"input": INPUT}, values)
    curve = gain * acting - u + 0.02 * np.sin(7 * u)
    best, *others = matching_laws("actuator", AT_DRIVE, {"input": INPUT}, curve, EVENLY)
    assert best.law.name == name and best.share > 0.95
    assert {name: best.values[name] for name in values} == pytest.approx(values, rel=0.2)
    assert best in worth_a_refit([best, *others])


def test_a_gain_is_neither_saturation_nor_dead_band() -> None:
    curve = -0.2 * INPUT.numpy() + 0.002 * np.sin(3 * INPUT.numpy())
    found = {m.law.name: m.share for m in matching_laws("actuator", AT_DRIVE, {"input": INPUT}, curve, EVENLY)}
    assert max(found, key=lambda name: found[name]) == "input_gain"
    assert found["torque_saturation"] == found["actuator_deadzone"] == 0.0


@pytest.mark.parametrize(("side", "where"), [(1.0, 3.1), (-1.0, -3.7)])
def test_a_stop_draws_a_curve_over_the_position_at_rest(side: float, where: float) -> None:
    """Seen: a knee's stop, told as an unknown curve over its angle: the law also depends on the speed, and was not asked."""
    stop = LIBRARY["end_stop"]()
    drawn = {"k": 40.0, "where": where, "c": 3.0, "side": side}
    force = law_force(stop, AROUND, {"position": SPEED}, drawn)
    moving = law_force(stop, AROUND, {"position": SPEED, "speed": torch.full_like(SPEED, side)}, drawn)
    assert np.abs(moving - force).max() == pytest.approx(3.0)
    best = worth_a_refit(matching_laws("body", AROUND, {"position": SPEED}, force, EVENLY))[0]
    assert best.law.name == "end_stop" and best.share == pytest.approx(1.0, abs=1e-6)
    assert best.values["where"] == pytest.approx(where, abs=0.01) and best.values["k"] == pytest.approx(40.0, rel=0.01)
    assert (best.values["c"], best.values["side"]) == (0.0, side)
    assert "end_stop" not in {m.law.name for m in matching_laws("body", AROUND, {"speed": SPEED}, force, EVENLY)}
