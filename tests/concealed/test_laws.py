"""Concealed laws of bodies and couplings: friction never drives, play is free in its gap, dampers dissipate."""

from __future__ import annotations

import numpy as np
import pytest

from experiments.concealed.laws import Law, Motion, body, coupling
from experiments.concealed.plant_arm import NOMINAL
from tests.concealed.lanes import LANES, SAMPLE_TIME, make, motion

FRICTIONS = [
    make(body.Viscous, "arm", c=0.01),
    make(body.Coulomb, "gearbox", level=0.4, v_0=0.2),
    make(body.Stribeck, "arm", level=0.2, extra=0.4, v_s=4.0, c=0.002, v_0=0.3),
    make(body.QuadraticDrag, "motor", c=0.001),
    make(body.LoadDependentFriction, "motor", c=0.15, v_0=1.2),
    make(body.PositionDependentFriction, "motor", level=0.2, order=3.0, phase=1.0, v_0=0.5),
    make(body.FrictionWarmup, "motor", change=0.3, T=2.0, grows=0.0, v_0=0.3),
    make(body.FrictionWarmup, "motor", change=0.3, T=2.0, grows=1.0, v_0=0.3),
    make(body.SpeedBump, "motor", height=0.5, center=15.0, width=3.0, v_0=1.0),
    make(body.SpeedWaves, "gearbox", height=0.5, spacing=3.0, v_0=1.0),
]


@pytest.mark.parametrize("law", FRICTIONS, ids=lambda law: type(law).__name__)
def test_friction_never_drives(law: body.BodyForce):
    m = motion(law)
    v = m.speed(law.port, law.lanes)
    power = law.force(m, v) * v
    assert np.all(power <= 0.0)
    assert power.min() < -0.01


def test_asymmetric_friction_never_drives_as_part_of_the_whole():
    law = make(body.CoulombAsymmetry, "motor", difference=0.1, v_0=1.0 / NOMINAL["beta"])
    m = motion(law)
    v = m.speed("motor", law.lanes)
    whole = -NOMINAL["F_c"] * np.tanh(NOMINAL["beta"] * v) + law.force(m, v)
    assert np.all(whole * v <= 0.0)
    fast = np.abs(v) > 10.0
    np.testing.assert_allclose(np.abs(whole[fast & (v > 0)]), NOMINAL["F_c"] + 0.1, rtol=1e-4)
    np.testing.assert_allclose(np.abs(whole[fast & (v < 0)]), NOMINAL["F_c"] - 0.1, rtol=1e-4)


def test_end_stop_only_pushes_back_and_only_past_the_limit():
    law = make(body.EndStop, "arm", limit=10.0, side=1.0, stiffness=5.0, damping=0.02)
    m = motion(law)
    force = law.force(m, m.speed("arm", law.lanes))
    past = m.position("arm", law.lanes) > 10.0
    assert np.all(force[~past] == 0.0)
    assert np.all(force[past] <= 0.0)
    assert np.any(force[past] < -1.0)


def test_backlash_is_free_in_the_gap_and_continuous_at_its_edge():
    law = make(coupling.Backlash, "gear_spring", half_gap=0.04)
    m = motion(law)
    twist = m.gear_deflection.copy()
    law.apply(m)
    inside = np.abs(twist) < 0.04
    assert np.all(m.gear_deflection[inside] == 0.0)
    np.testing.assert_allclose(np.abs(m.gear_deflection[~inside]), np.abs(twist[~inside]) - 0.04)
    assert 20 < inside.sum() < LANES - 20


@pytest.mark.parametrize(
    ("law", "odd"),
    [
        (make(coupling.CubicStiffness, "arm_spring", cubic=200.0), True),
        (make(coupling.SofteningSpring, "arm_spring", level=0.3, d_0=0.02), True),
        (make(coupling.WavySpring, "arm_spring", height=0.3, spacing=0.02), False),
    ],
    ids=["cubic", "softening", "wavy"],
)
def test_extra_springs(law: coupling.Coupling, odd: bool):
    m = motion(law)
    before = m.arm_torque.copy()
    law.apply(m)
    work = (m.arm_torque - before) * m.arm_deflection
    assert np.any(work > 0.0)
    assert np.all(work >= 0.0) == odd  # the wavy one pulls away from rest in places: no monotone spring does


@pytest.mark.parametrize(
    "law",
    [
        make(coupling.QuadraticDamping, "gear_spring", c=0.01),
        make(coupling.SpeedTunedDamping, "gear_spring", c=0.05, center=15.0, width=5.0),
    ],
    ids=["quadratic", "tuned"],
)
def test_dampers_only_dissipate(law: coupling.Coupling):
    m = motion(law)
    before = m.gear_torque.copy()
    law.apply(m)
    power = (m.gear_torque - before) * m.gear_rate
    assert np.all(power >= 0.0)
    assert power.max() > 0.1


def work_over_a_cycle(law: Law, speeds: np.ndarray, force: str, row_of_speed: tuple[int, ...]) -> float:
    """Work that goes into a law with memory while its rate runs through `speeds`, one lane, after two cycles to settle."""
    law.first_row, step = 6, SAMPLE_TIME / 8
    state = np.zeros((6 + law.memory, 1))
    work = 0.0
    for cycle in range(3):
        for v in speeds:
            for row in row_of_speed:
                state[row] = v
            m = Motion(0.0, state, np.zeros(1))
            m.gear_spring, m.gear_torque, m.arm_torque, m.motor_force = (np.zeros(1) for _ in range(4))
            law.apply(m)
            if cycle == 2:
                work += float(getattr(m, force)[0] * v * step)
            state = state + step * m.rates
    return work


def test_bristle_and_hysteron_dissipate_over_a_closed_cycle():
    angle = np.linspace(0.0, 2.0 * np.pi, 8000, endpoint=False)
    speeds = 2.0 * np.cos(angle)  # 0.5 s a cycle, 0.16 rad either way
    bristle = make(body.Bristle, "motor", 1, level=0.3, stiffness=6.0, damping=0.006)
    travel = float(np.abs(speeds).sum() * SAMPLE_TIME / 8)
    lost = -work_over_a_cycle(bristle, speeds, "motor_force", (2,))
    assert 0.5 * 0.3 * travel < lost < 0.3 * travel
    hysteron = make(coupling.HystereticSpring, "gear_spring", 1, stiffness=8.0, **{"yield": 0.04})
    lost = work_over_a_cycle(hysteron, speeds, "gear_torque", (2,))
    assert 0.3 * 8.0 * 0.04 * travel < lost < 8.0 * 0.04 * travel


def test_bristle_slides_at_its_level():
    law = make(body.Bristle, "motor", level=0.3, stiffness=6.0, damping=0.0)
    m = motion(law, memory=np.full(LANES, 0.05))
    law.apply(m)
    forward = m.motor_speed > 0
    np.testing.assert_allclose(m.rates[6, forward], 0.0, atol=1e-12)
    np.testing.assert_allclose(m.motor_force[forward], -0.3)
