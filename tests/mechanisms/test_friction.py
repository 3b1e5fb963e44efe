"""Laws of friction: limits, symmetry, and that friction never drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction, QuadraticDrag, ViscousFriction
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.varying_friction import FrictionWarmup, LoadDependentFriction, PositionDependentFriction

SPEEDS = np.linspace(-15.0, 15.0, 301)

speeds = st.floats(-50.0, 50.0)
levels = st.floats(0.0, 20.0)
widths = st.floats(0.05, 5.0)


@pytest.mark.parametrize(
    ("mechanism", "values"),
    [
        (ViscousFriction(), {"c": 0.3}),
        (CoulombFriction(), {"F_c": 2.0}),
        (StribeckFriction(), {"F_c": 2.0, "F_s": 1.0, "c": 0.1}),
        (QuadraticDrag(), {"c": 0.3}),
        (LoadDependentFriction(), {"c": 0.3}),
        (FrictionWarmup(), {"delta": 2.0}),
        (PositionDependentFriction(), {"a": 0.4, "b": -0.2}),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_odd_in_speed(mechanism, values, law) -> None:
    others = {name: np.full(301, 1.3) for name in mechanism.needs if name != "speed"}
    forward = law(mechanism, values, speed=SPEEDS, **others)
    np.testing.assert_allclose(law(mechanism, values, speed=-SPEEDS, **others), -forward, rtol=1e-14)
    assert np.abs(forward).max() > 0.01


def test_viscous_is_proportional(law) -> None:
    np.testing.assert_allclose(law(ViscousFriction(), {"c": 0.3}, speed=SPEEDS), -0.3 * SPEEDS)


def test_coulomb_saturates(law) -> None:
    force = law(CoulombFriction(), {"F_c": 2.0, "v_0": 0.1}, speed=SPEEDS)
    np.testing.assert_allclose(force[SPEEDS > 1.0], -2.0, rtol=1e-8)
    assert law(CoulombFriction(), {"F_c": 2.0, "v_0": 0.1}, speed=np.array(0.1)) == pytest.approx(-2.0 * np.tanh(1.0))


def test_uneven_friction_with_a_level_has_one_for_each_direction(law) -> None:
    uneven, values = CoulombAsymmetry(with_level=True), {"F_c": 2.0, "delta": -0.5, "v_0": 0.1}
    force = law(uneven, values, speed=SPEEDS)
    np.testing.assert_allclose(force[SPEEDS > 1.0], -1.5, rtol=1e-8)
    np.testing.assert_allclose(force[SPEEDS < -1.0], 2.5, rtol=1e-8)
    assert (force * SPEEDS <= 0.0).all() and type(uneven)(**uneven.options()).options() == {"with_level": True}


def test_uneven_friction_is_dry_friction_and_a_constant_force_in_motion(law) -> None:
    uneven, values = CoulombAsymmetry(with_level=True), {"F_c": 2.0, "delta": -0.5, "v_0": 0.1}
    parts = uneven.as_two(values)
    assert [m.name for m, _ in parts] == ["coulomb_friction", "constant_bias"]
    both = sum(law(m, own, speed=SPEEDS) for m, own in parts)
    moving = np.abs(SPEEDS) > 1.0
    np.testing.assert_allclose(both[moving], law(uneven, values, speed=SPEEDS)[moving], rtol=1e-7)
    assert law(parts[1][0], parts[1][1], speed=np.array(0.0)) == pytest.approx(0.5), (
        "it pushes at rest, friction does not"
    )
    assert not CoulombAsymmetry().as_two({"delta": -0.5, "v_0": 0.1}) and not CoulombFriction().as_two({"F_c": 2.0})


@pytest.mark.parametrize(("delta", "pushes"), [(1.9, False), (-1.9, False), (2.1, True), (-2.1, True)])
def test_a_difference_of_levels_larger_than_friction_is_not_friction(around, delta, pushes) -> None:
    told = CoulombAsymmetry(with_level=True).misplaced(around, {"F_c": 2.0, "delta": delta, "v_0": 0.1})
    assert ("friction would push" in (told or "")) is pushes


@pytest.mark.parametrize(("delta", "told"), [(0.02, True), (-0.02, True), (0.06, False)])
def test_levels_that_hardly_differ_are_one(around, delta, told) -> None:
    """Seen: dry friction of a double pendulum's joint, 0.168 N m, told as friction that differs by direction for 0.003 N m (0.97)."""
    law, values = CoulombAsymmetry(with_level=True), {"delta": delta, "F_c": 1.0, "v_0": 0.01}
    assert ("hardly differ" in (law.misplaced(around, values) or "")) is told
    assert CoulombAsymmetry().misplaced(around, values) is None
    assert CoulombAsymmetry().misplaced(around, {"delta": delta, "v_0": 0.1}) is None


def test_stribeck_friction_begins_as_the_dry_friction_that_it_contains(law) -> None:
    dry = {"F_c": 2.0, "v_0": 0.1}
    begun = {"c": 0.0, "v_s": 1.0, **StribeckFriction().begun_as("coulomb_friction", dry)}
    np.testing.assert_array_equal(
        law(StribeckFriction(), begun, speed=SPEEDS), law(CoulombFriction(), dry, speed=SPEEDS)
    )
    assert not StribeckFriction().begun_as("viscous_friction", {"c": 0.3})


def test_drag_is_quadratic(law) -> None:
    slow, fast = law(QuadraticDrag(), {"c": 0.3}, speed=np.array([2.0, 4.0]))
    assert (slow, fast) == (pytest.approx(-1.2), pytest.approx(-4.8))


def test_asymmetry_is_even_and_vanishes_at_standstill(law) -> None:
    force = law(CoulombAsymmetry(), {"delta": 0.5}, speed=SPEEDS)
    np.testing.assert_allclose(force, law(CoulombAsymmetry(), {"delta": 0.5}, speed=-SPEEDS))
    assert force[0] == pytest.approx(-0.5) and force[150] == 0.0


def test_stribeck_falls_then_rises(law) -> None:
    values = {"F_c": 1.0, "F_s": 2.0, "c": 0.1, "v_s": 1.0, "v_0": 0.01}
    speed = np.linspace(0.1, 30.0, 3000)
    drag = -law(StribeckFriction(), values, speed=speed)
    lowest = int(np.argmin(drag))
    assert drag[0] == pytest.approx(3.0, abs=0.02)
    assert 1.5 < speed[lowest] < 3.0 and drag[lowest] < 1.3
    assert (np.diff(drag[:lowest]) < 0).all() and (np.diff(drag[lowest:]) > 0).all()
    assert drag[-1] == pytest.approx(1.0 + 0.1 * 30.0)


def test_load_counts_by_its_magnitude(law) -> None:
    values = {"c": 0.2, "v_0": 0.1}
    force = law(LoadDependentFriction(), values, speed=np.full(3, 5.0), load=np.array([-4.0, 0.0, 4.0]))
    np.testing.assert_allclose(force, [-0.8, 0.0, -0.8], atol=1e-12)


def test_warmup_decays(law) -> None:
    values = {"delta": 3.0, "T": 2.0, "v_0": 0.1}
    force = law(FrictionWarmup(), values, speed=np.full(3, 5.0), time=np.array([0.0, 2.0, 60.0]))
    np.testing.assert_allclose(force, [-3.0, -3.0 / np.e, 0.0], atol=1e-9)


def test_warmup_with_a_level_ends_at_that(law) -> None:
    values = {"F_c": 0.5, "delta": 3.0, "T": 2.0, "v_0": 0.1}
    warm, speed, time = FrictionWarmup(with_level=True), np.array([5.0, -5.0, 5.0]), np.array([0.0, 2.0, 60.0])
    np.testing.assert_allclose(law(warm, values, speed=speed, time=time), [-3.5, 0.5 + 3.0 / np.e, -0.5], atol=1e-9)
    ((richer, start),) = FrictionWarmup().richer({"delta": 3.0, "T": 2.0, "v_0": 0.1})
    assert richer.with_level and start == {**values, "F_c": 0.0} and not richer.richer(values)


def test_position_dependence_is_periodic(law) -> None:
    mechanism, values = PositionDependentFriction(3.0), {"a": 0.4, "b": -0.2, "v_0": 0.1}
    angle = np.linspace(0.0, 2.0, 100)
    force = law(mechanism, values, speed=np.full(100, 5.0), position=angle)
    again = law(mechanism, values, speed=np.full(100, 5.0), position=angle + 2 * np.pi / 3)
    np.testing.assert_allclose(force, again, atol=1e-12)
    assert np.ptp(force) == pytest.approx(2 * np.hypot(0.4, 0.2), rel=0.01)


def test_richer_forms_of_position_dependence_begin_as_it_was_found(law) -> None:
    values, angle = {"a": 0.4, "b": -0.2, "order": 3.0, "v_0": 0.1}, np.linspace(0.0, 2.0, 50)
    there = {"speed": np.full(50, -5.0), "position": angle}
    (harmonics, begun), (ripple, wave), (level, mean) = PositionDependentFriction(3.0).richer(values)
    assert harmonics.options() == {"order": 3.0, "harmonics": 3, "with_level": False}
    assert ripple.options() == {"order": 3.0, "harmonics": 3}
    plain = law(PositionDependentFriction(3.0), values, **there)
    np.testing.assert_allclose(law(harmonics, begun, **there), plain, atol=1e-14)
    np.testing.assert_allclose(law(ripple, wave, position=angle), plain, atol=1e-14)
    np.testing.assert_allclose(law(level, mean, **there), plain, atol=1e-14)
    np.testing.assert_allclose(law(level, {**mean, "F_c": 0.5}, **there), plain + 0.5, atol=1e-12)
    ((both, _),) = harmonics.richer(begun)
    assert both.options() == {"order": 3.0, "harmonics": 3, "with_level": True}
    assert both.richer({**begun, "F_c": 0.5}) == []


def test_harmonics_of_position_dependence_rub(law) -> None:
    angle, speed = np.linspace(0.0, 7.0, 60), np.repeat([4.0, -4.0], 30)
    values = {"b": 0.1, "a_2": 0.2, "b_3": 0.3, "order": 2.0, "v_0": 0.1}
    force = law(PositionDependentFriction(2.0, 3), values, speed=speed, position=angle)
    level = 0.1 * np.sin(2 * angle) + 0.2 * np.cos(4 * angle) + 0.3 * np.sin(6 * angle)
    np.testing.assert_allclose(force, -level * np.sign(speed), atol=1e-14)


@given(v=speeds, c=levels, F_c=levels, F_s=levels, v_s=widths, v_0=widths, load=speeds, t=st.floats(0.0, 100.0))
def test_friction_never_drives(law, v, c, F_c, F_s, v_s, v_0, load, t) -> None:
    v, load, t = np.array(v), np.array(load), np.array(t)
    forces = [
        law(ViscousFriction(), {"c": c}, speed=v),
        law(CoulombFriction(), {"F_c": F_c, "v_0": v_0}, speed=v),
        law(StribeckFriction(), {"F_c": F_c, "F_s": F_s, "c": c, "v_s": v_s, "v_0": v_0}, speed=v),
        law(QuadraticDrag(), {"c": c}, speed=v),
        law(LoadDependentFriction(), {"c": c, "v_0": v_0}, speed=v, load=load),
        law(FrictionWarmup(), {"delta": F_c, "v_0": v_0}, speed=v, time=t),
    ]
    assert all(force * v <= 0 for force in forces)


@given(v=speeds, a=st.floats(-5.0, 5.0), b=st.floats(-5.0, 5.0), v_0=widths, angle=st.floats(-10.0, 10.0))
def test_what_varies_a_coulomb_level_does_not_drive_with_it(law, v, a, b, v_0, angle) -> None:
    """An asymmetry or a periodic part alone drives in places; on top of a level at least as high it does not."""
    v, angle = np.array(v), np.array(angle)
    level = law(CoulombFriction(), {"F_c": np.hypot(a, b) * (1 + 1e-12), "v_0": v_0}, speed=v)
    varied = law(PositionDependentFriction(2.0), {"a": a, "b": b, "v_0": v_0}, speed=v, position=angle)
    assert (level + varied) * v <= 1e-12
    level = law(CoulombFriction(), {"F_c": abs(a), "v_0": v_0}, speed=v)
    assert (level + law(CoulombAsymmetry(), {"delta": a, "v_0": v_0}, speed=v)) * v <= 0


def test_friction_that_was_never_seen_to_fall_is_no_stribeck_friction(around: Surroundings) -> None:
    law = StribeckFriction()
    values = {"F_c": 1.0, "F_s": 0.5, "c": 0.1, "v_s": 8.0, "v_0": 0.1}
    certain = {name: 0.01 * value for name, value in values.items()}
    fast = replace(around, ranges={**around.ranges, "speed": Range(4.0, 20.0, 12.0)})
    assert law.degenerate(around, values, certain) is None  # standstill was recorded
    assert "only grows" in (law.degenerate(fast, values, certain) or "")
    assert law.degenerate(fast, values, {}) is None  # two laws are tried in its place first
    falling = {**values, "c": 0.01}
    assert law.degenerate(fast, falling, certain) is None
    assert [mechanism.name for mechanism, _ in law.as_two(values)] == ["coulomb_friction", "viscous_friction"]
    assert law.as_two(falling) == ()


def test_no_recording_is_promised_to_tell_a_bias_from_an_asymmetry_that_friction_holds() -> None:
    """Seen: "a bias pushes at rest" of a trolley that 4.5 N of dry friction hold; in motion both are a constant force."""
    assert ConstantBias.experiment == CoulombAsymmetry.experiment
    assert "where dry friction holds it, no recording" in ConstantBias.experiment
