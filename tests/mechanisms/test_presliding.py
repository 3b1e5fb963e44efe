"""Bristles: they store and dissipate, slip at once or by and by, and become Coulomb friction in sliding."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.stribeck import StribeckFriction

speeds = st.floats(-50.0, 50.0)
BRISTLE = {"F": 2.0, "z_0": 0.05}


@given(v=speeds, z=st.floats(-1.0, 1.0))
def test_bristle_only_stores_and_dissipates(law, rates, v, z) -> None:
    v, memory = np.array(v), {"bristle": np.array(z * 0.05)}
    force = law(PreslidingHysteresis(), BRISTLE, memory, speed=v)
    rate = rates(PreslidingHysteresis(), BRISTLE, memory, speed=v)[0]
    stored = 2.0 / 0.05 * memory["bristle"] * rate  # d/dt of F z² / (2 z_0)
    assert force * v + stored <= 1e-12
    assert abs(z) < 1.0 or z * rate <= 1e-9  # bent by no more than z_0


def test_bristle_dissipates_over_a_closed_cycle(law, rates) -> None:
    step, bristle, work = 5e-4, 0.0, []
    for t in step * np.arange(6_000):
        v, memory = np.array(3.0 * np.cos(2 * np.pi * t)), {"bristle": np.array(bristle)}
        work.append(float(law(PreslidingHysteresis(), BRISTLE, memory, speed=v) * v) * step)
        bristle += step * float(rates(PreslidingHysteresis(), BRISTLE, memory, speed=v)[0])
    per_cycle = np.array(work).reshape(3, -1).sum(axis=1)
    assert per_cycle[2] == pytest.approx(per_cycle[1], rel=1e-3)
    travel = 4 * 3.0 / (2 * np.pi)
    assert -2.0 * travel < per_cycle[2] < -0.8 * 2.0 * travel  # at most that of full sliding, and a good part of it


SHARP = {**BRISTLE, "sharpness": 0.7, "sigma": 0.3}


@given(v=speeds, z=st.floats(-1.0, 1.0), m=st.floats(0.0, 1.0), s=st.floats(0.0, 3.0))
def test_richer_bristles_only_store_and_dissipate(law, rates, v, z, m, s) -> None:
    """Within the deflection at which they slip at any speed; the damping of bristles that yield faster than the body moves would push."""
    richer, values = PreslidingHysteresis(True, True), {**SHARP, "sharpness": m, "sigma": 0.0, "s": s, "v_s": 4.0}
    v, memory = np.array(v), {"bristle": np.array(z * 0.05)}
    force, rate = law(richer, values, memory, speed=v), rates(richer, values, memory, speed=v)[0]
    assert force * v + 2.0 / 0.05 * memory["bristle"] * rate <= 1e-12


def _slid(law, rates, mechanism, values, v: float) -> list[float]:
    """The force while a body begins to move at a speed."""
    bristle, forces = 0.0, []
    for _ in range(4000):
        memory = {"bristle": np.array(bristle)}
        forces.append(float(law(mechanism, values, memory, speed=np.array(v))))
        bristle += 1e-4 * float(rates(mechanism, values, memory, speed=np.array(v))[0])
    return forces


def _sliding(law, rates, mechanism, values, v: np.ndarray) -> np.ndarray:
    """The force once bodies have moved at their speeds for long: 20 times as far as bristles bend at the slowest."""
    bristle = np.zeros_like(v)
    for _ in range(10_000):
        bristle = bristle + 2e-4 * rates(mechanism, values, {"bristle": bristle}, speed=v)[0]
    return law(mechanism, values, {"bristle": bristle}, speed=v)


def test_slip_sets_in_at_once(law, rates) -> None:
    """As an elasto-plastic element: a spring up to nearly the level, where Dahl's has long begun to yield."""
    plain = _slid(law, rates, PreslidingHysteresis(), BRISTLE, 1.0)
    sharp = _slid(law, rates, PreslidingHysteresis(sharp=True), {**BRISTLE, "sharpness": 1.0, "sigma": 0.0}, 1.0)
    spring = [-2.0 * 1e-4 * k / 0.05 for k in range(350)]  # 0.7 of the level
    np.testing.assert_allclose(sharp[:350], spring, rtol=0.02, atol=1e-9)
    assert abs(plain[349]) < 0.8 * abs(spring[-1]) and sharp[-1] == pytest.approx(-2.0, rel=1e-3)


def test_the_level_of_sliding_falls_with_speed(law, rates) -> None:
    values, v = {**BRISTLE, "s": 0.6, "v_s": 1.5}, np.array([0.5, 2.0, -2.0])
    slid = _sliding(law, rates, PreslidingHysteresis(falling=True), values, v)
    np.testing.assert_allclose(slid, -2.0 * np.sign(v) * (1.0 + 0.6 * np.exp(-((v / 1.5) ** 2))), rtol=1e-3)


def test_bristles_damp_by_their_own_rate(law, rates) -> None:
    memory, damped = {"bristle": np.array(0.01)}, PreslidingHysteresis(sharp=True)
    rate = rates(damped, SHARP, memory, speed=np.array(3.0))[0]
    undamped = law(damped, {**SHARP, "sigma": 0.0}, memory, speed=np.array(3.0))
    assert law(damped, SHARP, memory, speed=np.array(3.0)) == pytest.approx(undamped - 0.3 * rate)


def test_richer_forms_of_presliding_begin_where_it_was_found() -> None:
    """Seen: an arm's friction on an elastic seat, told with an unknown at the actuator beside it (0.50; 5 % left, 89 s; now 0.2 %, 9 s)."""
    forms = PreslidingHysteresis().richer(BRISTLE)
    assert [form.options() for form, _ in forms] == [
        {"sharp": True, "falling": False},
        {"sharp": False, "falling": True},
        {"sharp": True, "falling": True},
    ]
    assert all(start | BRISTLE == start for _, start in forms)
    assert [f.options() for f, _ in PreslidingHysteresis(sharp=True).richer(SHARP)] == [
        {"sharp": True, "falling": True}
    ]
    assert not PreslidingHysteresis(True, True).richer(SHARP)


def test_stribeck_friction_may_be_that_of_bristles(law, rates) -> None:
    """A law with a memory that slides at the same level. Seen: a painting robot's motor, whose bristles change the sign of the force so
    slowly that Stribeck friction was refused, and told without a name (149 s)."""
    values = {"F_c": 2.0, "F_s": 1.2, "c": 0.0, "v_s": 1.5, "v_0": 0.01}
    forms = StribeckFriction().richer(values)
    assert [form.options() for form, _ in forms] == [
        {"sharp": False, "falling": True},
        {"sharp": True, "falling": True},
    ]
    form, begun = forms[0]
    v = np.array([0.5, 2.0, -9.0])
    slid = _sliding(law, rates, form, {"z_0": 0.05, **begun}, v)
    np.testing.assert_allclose(slid, law(StribeckFriction(), values, speed=v), rtol=1e-3)


def test_friction_without_a_level_is_not_that_of_bristles() -> None:
    assert not StribeckFriction().richer({"F_c": 0.0, "F_s": 1.2, "c": 0.0, "v_s": 1.5, "v_0": 0.01})


def test_bristle_becomes_coulomb_in_sliding(law, rates) -> None:
    bristle = 0.0
    for _ in range(4000):
        bristle += 1e-4 * float(rates(PreslidingHysteresis(), BRISTLE, {"bristle": np.array(bristle)}, speed=1.0)[0])
    assert law(PreslidingHysteresis(), BRISTLE, {"bristle": np.array(bristle)}, speed=1.0) == pytest.approx(
        -2, rel=1e-3
    )


@pytest.mark.parametrize("sharpness", [0.0, 1.0])
@pytest.mark.parametrize("v", [0.1, 3.0, -50.0])
def test_steps_of_a_sample_follow_bristles_that_slip_within_less(rates, sharpness, v) -> None:
    """By Runge-Kutta steps of fourth order they stay bent to the level, at speeds at which they slip in a hundredth of a step."""
    mechanism = PreslidingHysteresis(sharp=True)
    values = {"F": 2.0, "z_0": 1e-3, "sharpness": sharpness, "sigma": 0.0}
    step, bent, found = 0.01, 0.0, []

    def rate(z: float) -> float:
        memory = {"bristle": np.array(z)}
        return float(rates(mechanism, values, memory, speed=np.array(v), sample_time=np.array(step))[0])

    for _ in range(200):
        k1 = rate(bent)
        k2 = rate(bent + 0.5 * step * k1)
        k3 = rate(bent + 0.5 * step * k2)
        bent += step / 6 * (k1 + 2 * k2 + 2 * k3 + rate(bent + step * k3))
        found.append(bent)
    assert max(abs(z) for z in found) < 1.6e-3
    assert found[-1] == pytest.approx(1e-3 * np.sign(v), rel=1e-6)


def test_slow_motion_is_followed_as_it_is(rates) -> None:
    memory, values = {"bristle": np.array(0.4e-3)}, {"F": 2.0, "z_0": 1e-3}
    found = rates(PreslidingHysteresis(), values, memory, speed=np.array(0.02), sample_time=np.array(0.01))[0]
    assert float(found) == pytest.approx(0.02 * 0.6)


def test_dry_friction_that_sticks_holds_a_push_below_its_level_and_slides_against_one_above(law, rates) -> None:
    """A mass of 1 kg, pushed with 1.5 N and then 2.5 N against 2 N: at rest for as long as it is pushed, then 0.5 m/s² from there."""
    sticking, values, step = CoulombFriction(sticking=True), {"F_c": 2.0, "z_0": 1e-4}, 2e-5
    bent, v, q, stood = 0.0, 0.0, 0.0, []
    for k in range(50_000):
        memory = {"bristle": np.array(bent)}
        push = 1.5 if k < 25_000 else 2.5
        force = float(law(sticking, values, memory, speed=np.array(v))) - 40.0 * v * (k < 25_000)
        bent += step * float(rates(sticking, values, memory, speed=np.array(v))[0])
        v += step * (push + force)
        q += step * v
        stood.append(q)
    assert stood[24_999] < 5e-4 and stood[24_999] == pytest.approx(stood[12_000], abs=5e-6)
    assert v == pytest.approx(0.5 * 0.5, rel=0.05)  # and what the bent bristles give back


@pytest.mark.parametrize(("sharp", "falling"), [(False, False), (True, False), (False, True), (True, True)])
def test_bristles_too_short_to_be_seen_are_dry_friction_that_sticks_in_every_form(sharp: bool, falling: bool) -> None:
    """Seen: a globe valve's packing, told as bristles of 19 um that slip at once and damp (0.97)."""
    values = {"F": 45.0, "z_0": 1.9e-5, "sharpness": 0.8, "sigma": 3000.0, "s": 0.005, "v_s": 0.002}
    ended = PreslidingHysteresis(sharp, falling).limit(values)
    assert ended is not None
    law, begun = ended
    assert isinstance(law, CoulombFriction) and law.sticking and begun == {"F_c": 45.0}
