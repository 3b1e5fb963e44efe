"""Concealed laws between recording and machine: delays, biases, static maps and lags."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from experiments.concealed.laws import Law, body, drive
from experiments.concealed.plant_arm import NOMINAL, ArmPlant, Drive
from tests.concealed.lanes import SAMPLE_TIME, make, motion


def held_torques(samples: int) -> np.ndarray:
    return np.random.default_rng(2).normal(scale=4.0, size=(samples, 1))


def simulate(torque: np.ndarray, law: Law | Sequence[Law] | None, samples_of_delay: int = 0) -> np.ndarray:
    """Open loop from rest, the torque delayed by whole samples if asked."""
    late = np.concatenate([np.repeat(torque[:1], samples_of_delay, axis=0), torque])[: len(torque)]
    laws = [] if law is None else [law] if isinstance(law, Law) else law
    plant = ArmPlant({name: np.array([value]) for name, value in NOMINAL.items()}, laws)
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


@pytest.mark.parametrize(("past", "switches"), [(drive.OutputDelay, {"delay": 0.002}), (drive.SensorLag, {"T": 0.004})])
def test_a_sensor_shows_what_it_adds_and_its_gain_beside_what_is_past(past: type[Law], switches: dict[str, float]):
    torque = held_torques(60)

    def late() -> Law:
        return make(past, "sensor", 1, **switches)

    alone = simulate(torque, late())
    biased = simulate(torque, [make(drive.SensorBias, "sensor", 1, bias=0.3), late()])
    scaled = simulate(torque, [make(drive.SensorGain, "sensor", 1, gain=1.2), late()])
    np.testing.assert_allclose(biased, alone + 0.3, atol=1e-12)
    np.testing.assert_allclose(scaled, 1.2 * alone, atol=1e-12)


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
