from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from experiments.concealed.laws import Law, Motion, body, coupling, drive
from experiments.concealed.plant_arm import NOMINAL, ArmPlant, Drive

SAMPLE_TIME = 0.0005
LANES = 200


def make(law: type[Law], port: str, lanes: int = LANES, **switches: float) -> Any:
    return law(np.arange(lanes), {name: np.full(lanes, value) for name, value in switches.items()}, port)


def motion(law: Law, *, memory: np.ndarray | None = None) -> Motion:
    """Random states on `LANES` lanes: twists, speeds, position, and the law's memory."""
    rng = np.random.default_rng(0)
    state = np.zeros((6 + law.memory, LANES))
    state[:2] = rng.normal(scale=0.1, size=(2, LANES))
    state[2:5] = rng.normal(scale=15.0, size=(3, LANES))
    state[5] = rng.uniform(-30.0, 30.0, LANES)
    law.first_row, law.sample_time, law.step = 6, SAMPLE_TIME, SAMPLE_TIME / 8
    if memory is not None:
        state[6:] = memory
    m = Motion(0.5, state, rng.normal(scale=5.0, size=LANES))
    m.gear_spring = 20.0 * m.gear_deflection
    m.gear_torque = m.gear_spring + 0.03 * m.gear_rate
    m.arm_torque = 11.0 * m.arm_deflection + 0.003 * m.arm_rate
    m.motor_force = np.zeros(LANES)
    return m


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


def held_torques(samples: int) -> np.ndarray:
    return np.random.default_rng(2).normal(scale=4.0, size=(samples, 1))


def simulate(torque: np.ndarray, law: Law | None, samples_of_delay: int = 0) -> np.ndarray:
    """Open loop from rest, the torque delayed by whole samples if asked."""
    late = np.concatenate([np.repeat(torque[:1], samples_of_delay, axis=0), torque])[: len(torque)]
    plant = ArmPlant({name: np.array([value]) for name, value in NOMINAL.items()}, [law] if law else [])
    zero = np.zeros((len(torque), 1))
    nothing = np.zeros(1)
    return plant.run(plant.initial_state(np.zeros((3, 1))), Drive(late, zero, zero, nothing, nothing)).speed


def test_input_delay_of_whole_samples_is_exact():
    torque = held_torques(200)
    law = make(drive.InputDelay, "actuator", 1, delay=3 * SAMPLE_TIME)
    np.testing.assert_allclose(simulate(torque, law), simulate(torque, None, 3), rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("delay", [0.25, 0.4, 1.7])
def test_input_delay_of_parts_of_samples_acts_on_time(delay: float):
    """Of a step of torque at rest, the momentum gained tells when it began to act."""
    torque = np.zeros((40, 1))
    torque[10:] = 8.0
    law = make(drive.InputDelay, "actuator", 1, delay=delay * SAMPLE_TIME)
    plant = ArmPlant({n: np.array([0.0 if n in ("F_v", "F_c", "F_cs") else v]) for n, v in NOMINAL.items()}, [law])
    shares = NOMINAL["J"] * np.array([NOMINAL["a_m"], NOMINAL["a_g"], 1.0 - NOMINAL["a_m"] - NOMINAL["a_g"]])
    momentum: list[float] = []
    zero = np.zeros((40, 1))
    plant.run(
        plant.initial_state(np.zeros((3, 1))),
        Drive(torque, zero, zero, np.zeros(1), np.zeros(1)),
        observe=lambda k, state: momentum.append(float(shares @ state[2:5, 0])),
    )
    began = 30.0 - 1.0 - momentum[-1] / (8.0 * SAMPLE_TIME)  # the last sample is seen at its beginning
    assert began == pytest.approx(delay, abs=1e-9)


@pytest.mark.parametrize("delay", [2.0, 3.3])
def test_output_delay_shows_the_past(delay: float):
    torque = np.repeat(held_torques(30), 20, axis=0)
    now = simulate(torque, None)[:, 0]
    late = simulate(torque, make(drive.OutputDelay, "sensor", 1, delay=delay * SAMPLE_TIME))[:, 0]
    samples = np.arange(len(now))
    expected = np.interp(samples - delay, samples, now)
    np.testing.assert_allclose(late[10:], expected[10:], atol=0.02 if delay % 1 else 1e-9)


def test_delays_of_input_and_output_are_twins():
    torque = held_torques(400)
    at_input = simulate(torque, make(drive.InputDelay, "actuator", 1, delay=0.002))
    at_output = simulate(torque, make(drive.OutputDelay, "sensor", 1, delay=0.002))
    # They differ in what they take for granted before the recording alone: rest there, the first torque here.
    now = simulate(torque, None)
    np.testing.assert_allclose(at_output, now[np.maximum(np.arange(400) - 4, 0)], atol=1e-9)
    np.testing.assert_allclose(at_input, simulate(torque, None, 4), atol=1e-9)


def test_bias_at_actuator_and_motor_are_twins():
    torque = held_torques(200)
    at_input = simulate(torque, make(drive.InputBias, "actuator", 1, bias=0.2))
    at_motor = simulate(torque, make(body.ConstantBias, "motor", 1, bias=0.2))
    np.testing.assert_allclose(at_input, at_motor, atol=1e-10)


def test_static_maps_of_the_torque():
    u = np.array([-9.0, -0.1, 0.0, 0.1, 9.0])
    m = motion(make(drive.InputBias, "actuator", bias=0.0))
    limit = make(drive.TorqueSaturation, "actuator", 5, limit=6.0)
    np.testing.assert_array_equal(limit.torque(m, u), [-6.0, -0.1, 0.0, 0.1, 6.0])
    gap = make(drive.ActuatorDeadzone, "actuator", 5, half_width=0.2)
    np.testing.assert_allclose(gap.torque(m, u), [-8.8, 0.0, 0.0, 0.0, 8.8])


def test_lags_follow_a_step_exponentially():
    torque = np.full((200, 1), 3.0)
    time = np.arange(200) * SAMPLE_TIME
    seen: list[float] = []
    law = make(drive.InputLag, "actuator", 1, T=0.003)
    plant = ArmPlant({name: np.array([value]) for name, value in NOMINAL.items()}, [law])
    zero = np.zeros((200, 1))
    plant.run(
        plant.initial_state(np.zeros((3, 1))),
        Drive(torque, zero, zero, np.zeros(1), np.zeros(1)),
        observe=lambda k, state: seen.append(float(state[law.first_row, 0])),
    )
    np.testing.assert_allclose(seen, 3.0 * (1.0 - np.exp(-time / 0.003)), atol=1e-3)
