"""The plant of one body against analytic solutions and an independent, event-aware integrator."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from experiments.concealed.laws import Law, body, drive, dry
from experiments.concealed.laws.nuisance import Disturbance, Jitter
from experiments.concealed.plant_body import BodyDrive, BodyPlant, BodyRecordings

SAMPLE_TIME = 0.001
ONE = np.array([0])


def make(law: type[Law], port: str = "carriage", **switches: float) -> Any:
    return law(ONE, {name: np.array([value]) for name, value in switches.items()}, port)


def simulate(
    force: np.ndarray,
    laws: list[Law] | None = None,
    *,
    start: tuple[float, float] = (0.0, 0.0),
    machine: tuple[float, float, float] = (2.0, 3.0, 0.0),
    steps: int = 10,
    seen: list[np.ndarray] | None = None,
) -> tuple[BodyPlant, BodyRecordings]:
    """Open loop, one lane, position and speed measured without noise. `machine`: inertia, damping, gravity."""
    plant = BodyPlant(
        *(np.array([value]) for value in machine),
        laws or [],
        output_rows=(0, 1),
        sensors=("sensor.position", "sensor.speed"),
        sample_time=SAMPLE_TIME,
        steps_per_sample=steps,
    )
    column = np.asarray(force, float)[:, None]
    nothing = np.zeros_like(column)
    run = BodyDrive(column, nothing, np.zeros((2, len(column), 1)), np.zeros(1), np.zeros(1), np.zeros(2))
    observe = None if seen is None else lambda k, state: seen.append(state.copy())
    recordings = plant.run(plant.initial_state(np.array([start[0]]), np.array([start[1]])), run, observe=observe)
    return plant, recordings


def test_a_pushed_carriage_approaches_its_speed_exponentially():
    _, run = simulate(np.full(2000, 6.0))
    time = np.arange(2000) * SAMPLE_TIME
    speed = 2.0 * (1.0 - np.exp(-1.5 * time))
    np.testing.assert_allclose(run.outputs[1, :, 0], speed, atol=1e-8)
    np.testing.assert_allclose(run.outputs[0, :, 0], 2.0 * time - speed / 1.5, atol=1e-8)


def test_an_undamped_pendulum_keeps_its_energy_and_has_the_small_swings_period():
    seen: list[np.ndarray] = []
    plant, _ = simulate(np.zeros(3000), start=(2.5, 0.0), machine=(0.15, 0.0, 2.7), seen=seen)
    energy = np.array([plant.energy(state)[0] for state in seen])
    np.testing.assert_allclose(energy, energy[0], rtol=1e-6)
    _, small = simulate(np.zeros(3000), start=(1e-3, 0.0), machine=(0.15, 0.0, 2.7))
    time = np.arange(3000) * SAMPLE_TIME
    np.testing.assert_allclose(small.outputs[0, :, 0], 1e-3 * np.cos(np.sqrt(2.7 / 0.15) * time), atol=1e-8)


def test_dry_friction_stops_a_sliding_body_for_good_and_holds_it_below_its_level():
    _, run = simulate(np.full(2000, 0.5), [make(dry.DryCoulomb, level=2.5)], start=(0.0, 0.4), machine=(2.0, 0.0, 0.0))
    time = np.arange(2000) * SAMPLE_TIME
    stop = 0.4  # s: the force left is 2 N on 2 kg
    np.testing.assert_allclose(run.outputs[1, :, 0], np.maximum(0.4 - 1.0 * time, 0.0), atol=1e-9)
    stood = run.outputs[0, time > stop + SAMPLE_TIME, 0]
    assert np.all(stood == stood[0])
    assert stood[0] == pytest.approx(0.5 * 0.4 * stop, abs=1e-5)


def test_dry_friction_breaks_away_above_its_level():
    force = np.where(np.arange(2000) < 1000, 2.4, 2.6)
    _, run = simulate(force, [make(dry.DryCoulomb, level=2.5)], machine=(2.0, 0.0, 0.0))
    speed = run.outputs[1, :, 0]
    assert np.all(speed[:1001] == 0.0)
    np.testing.assert_allclose(speed[1000:], 0.05 * SAMPLE_TIME * np.arange(1000), atol=1e-9)


def coulomb_swing(level: float, start: float, machine: tuple[float, float, float], duration: float) -> np.ndarray:
    """Positions at the samples, by DOP853 from one standstill to the next, found as events; rest where friction holds."""
    inertia, damping, gravity = machine
    time, state = 0.0, np.array([start, 0.0])
    wanted = np.arange(round(duration / SAMPLE_TIME)) * SAMPLE_TIME
    position = np.full(len(wanted), np.nan)
    while time < duration:
        pull = -gravity * np.sin(state[0])
        left = wanted >= time - 1e-12
        if abs(pull) <= level:
            position[left] = state[0]
            return position
        sign = np.sign(pull)

        def equations(t: float, x: np.ndarray, sign: float = sign) -> list[float]:
            return [x[1], (-damping * x[1] - gravity * np.sin(x[0]) - level * sign) / inertia]

        def stands(t: float, x: np.ndarray, sign: float = sign, since: float = time) -> float:
            return sign * x[1] if t > since + 1e-6 else 1.0

        stands.terminal = True  # type: ignore[attr-defined]
        done = solve_ivp(
            equations, (time, duration), state, "DOP853", rtol=1e-10, atol=1e-12, events=stands, dense_output=True
        )
        inside = left & (wanted <= done.t[-1])
        position[inside] = done.sol(wanted[inside])[0]
        time, state = float(done.t[-1]), np.array([done.y[0, -1], 0.0])
    return position


def test_stick_and_slip_match_an_event_aware_solver():
    machine = (0.15, 0.02, 2.7)
    _, run = simulate(np.zeros(4000), [make(dry.DryCoulomb, "pivot", level=0.5)], start=(1.4, 0.0), machine=machine)
    expected = coulomb_swing(0.5, 1.4, machine, 4.0)
    np.testing.assert_allclose(run.outputs[0, :, 0], expected, atol=5e-4)
    assert np.ptp(run.outputs[0, -200:, 0]) == 0.0  # it has come to rest, off the bottom
    assert abs(run.outputs[0, -1, 0]) > 0.01


def test_stribeck_level_falls_with_speed_and_warmth_with_time():
    stribeck = make(dry.DryStribeck, level=1.0, extra=0.5, v_s=0.1)
    assert stribeck.level(0.0, np.zeros(1)) == pytest.approx(1.5)
    assert stribeck.level(0.0, np.array([1.0])) == pytest.approx(1.0)
    warm = make(dry.DryWarmup, change=1.0, T=2.0)
    assert warm.level(2.0, np.zeros(1)) == pytest.approx(np.exp(-1.0))
    assert warm.level(-1.0, np.zeros(1)) == pytest.approx(1.0)  # before the recording: cold


@pytest.mark.parametrize("stiff", ["bristle", "end stop"])
def test_stiff_laws_match_a_stiff_solver(stiff: str):
    force = 8.0 * np.sin(2.0 * np.pi * 1.5 * np.arange(1000) * SAMPLE_TIME)
    if stiff == "bristle":
        law = make(body.Bristle, level=2.0, stiffness=2.0 / 2e-4, damping=3.0)
    else:
        law = make(body.EndStop, limit=0.02, side=1.0, stiffness=8000.0, damping=10.0)
    _, run = simulate(force, [law])

    def equations(t: float, x: np.ndarray, u: float) -> list[float]:
        position, speed, z = x
        slip, push = 0.0, 0.0
        if stiff == "bristle":
            slip = speed - 1e4 * abs(speed) * z / 2.0
            push = -(1e4 * z + 3.0 * slip)
        elif position > 0.02:
            push = -max(8000.0 * (position - 0.02) + 10.0 * speed, 0.0)
        return [speed, (u - 3.0 * speed + push) / 2.0, slip]

    x, expected = np.zeros(3), []
    for u in force:
        expected.append(x[0])
        solved = solve_ivp(equations, (0.0, SAMPLE_TIME), x, "LSODA", rtol=1e-9, atol=1e-12, args=(u,))
        x = solved.y[:, -1]
    np.testing.assert_allclose(run.outputs[0, :, 0], expected, atol=5e-5)


def test_smooth_laws_match_an_adaptive_solver():
    force = 5.0 * np.random.default_rng(0).normal(size=400).cumsum() / 20.0
    laws = [make(body.QuadraticDrag, c=4.0), make(body.TorqueRipple, amplitude=1.0, order=40.0, phase=0.3)]
    _, run = simulate(force, laws)

    def equations(t: float, x: np.ndarray, u: float) -> list[float]:
        push = -4.0 * x[1] * abs(x[1]) + np.sin(40.0 * x[0] + 0.3)
        return [x[1], (u - 3.0 * x[1] + push) / 2.0]

    x, expected = np.zeros(2), []
    for u in force:
        expected.append(x[0])
        x = solve_ivp(equations, (0.0, SAMPLE_TIME), x, "DOP853", rtol=1e-10, atol=1e-13, args=(u,)).y[:, -1]
    np.testing.assert_allclose(run.outputs[0, :, 0], expected, atol=1e-8)


def shaken() -> np.ndarray:
    return np.repeat(np.random.default_rng(4).normal(scale=30.0, size=30), 20)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ((drive.InputBias, "actuator", {"bias": 0.4}), (body.ConstantBias, "carriage", {"bias": 0.4})),
        ((drive.InputLag, "actuator", {"T": 0.01}), (drive.SensorLag, "sensor.position", {"T": 0.01})),
        ((drive.InputGain, "actuator", {"gain": 1.3}), (drive.SensorGain, "sensor.position", {"gain": 1.3})),
        ((drive.InputDelay, "actuator", {"delay": 0.007}), (drive.OutputDelay, "sensor.position", {"delay": 0.007})),
    ],
    ids=["bias", "lag", "gain", "delay"],
)
def test_twins_of_a_linear_carriage(one: tuple[Any, str, dict], other: tuple[Any, str, dict]):
    """What the key accepts for one another is the same in the recording, from rest."""
    force = np.concatenate([np.zeros(20), shaken()])
    first, second = (simulate(force, [make(law, port, **switches)])[1] for law, port, switches in (one, other))
    assert np.ptp(first.outputs[0]) > 0.01
    np.testing.assert_allclose(first.outputs[0], second.outputs[0], atol=2e-6)


def test_on_a_pendulum_gains_of_input_and_sensor_differ():
    force = np.full(800, 1.5)
    swing = {"machine": (0.15, 0.05, 2.7)}
    at_input = simulate(force, [make(drive.InputGain, "actuator", gain=1.3)], **swing)[1]
    at_sensor = simulate(force, [make(drive.SensorGain, "sensor.position", gain=1.3)], **swing)[1]
    assert np.abs(at_input.outputs[0] - at_sensor.outputs[0]).max() > 0.05
    np.testing.assert_array_equal(at_sensor.outputs[1], simulate(force, **swing)[1].outputs[1])  # of the other sensor


def test_feedback_follows_its_reference_with_the_noise_in_the_command():
    rng = np.random.default_rng(1)
    plant = BodyPlant(np.array([2.0]), np.array([3.0]), np.zeros(1), sample_time=SAMPLE_TIME)
    noise = 1e-5 * rng.normal(size=(1, 400, 1))
    reference = np.full((400, 1), 0.05)
    feed = BodyDrive(np.zeros((400, 1)), reference, noise, np.array([300.0]), np.array([40.0]), np.array([5e-6]))
    run = plant.run(plant.initial_state(np.zeros(1), np.zeros(1)), feed)
    assert run.outputs[0, -1, 0] == pytest.approx(0.05, abs=0.005)
    steps = run.outputs[0] / 5e-6
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)  # read out in steps of 5 um
    assert run.command[0, 0] == pytest.approx(300.0 * (0.05 - run.outputs[0, 0, 0]))


def test_disturbance_is_held_over_its_sample_and_jitter_moves_along_the_slope():
    values = np.zeros((100, 1))
    values[10] = 4.0
    _, run = simulate(np.zeros(100), [Disturbance(ONE, values, "carriage", 0.0)], machine=(2.0, 0.0, 0.0))
    np.testing.assert_allclose(run.outputs[1, 12:, 0], 4.0 * SAMPLE_TIME / 2.0, rtol=1e-9)
    assert run.outputs[1, 10, 0] == 0.0
    late = np.full((100, 1), 2e-4)
    _, moving = simulate(
        np.zeros(100), [Jitter(ONE, late, "sensor.position")], start=(0.0, 1.5), machine=(2.0, 0.0, 0.0)
    )
    time = np.arange(100) * SAMPLE_TIME
    np.testing.assert_allclose(moving.outputs[0, 1:, 0], 1.5 * (time[1:] + 2e-4), atol=1e-12)
