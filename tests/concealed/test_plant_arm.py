from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from experiments.concealed.excitation import multisine
from experiments.concealed.laws.coupling import TransmissionError
from experiments.concealed.plant_arm import NOMINAL, ArmPlant, Drive

SAMPLE_TIME = 0.0005


def parameters(**changes: float) -> dict[str, np.ndarray]:
    return {name: np.array([value]) for name, value in {**NOMINAL, **changes}.items()}


def free_drive(samples: int, lanes: int = 1) -> Drive:
    """No torque, no feedback, no noise."""
    zero = np.zeros((samples, 1))
    return Drive(zero + np.zeros(lanes), zero, zero, np.zeros(lanes), np.zeros(lanes))


def wound(plant: ArmPlant) -> np.ndarray:
    state = plant.initial_state(np.array([[12.0], [9.0], [14.0]]))
    state[0], state[1] = 0.2, -0.1
    return state


def energies(plant: ArmPlant, samples: int = 1000) -> np.ndarray:
    seen: list[float] = []
    plant.run(wound(plant), free_drive(samples), observe=lambda k, state: seen.append(plant.energy(state)[0]))
    return np.array(seen)


FRICTIONLESS = {"F_v": 0.0, "F_c": 0.0, "F_cs": 0.0, "d_g": 0.0, "d_a": 0.0}


def test_without_friction_and_damping_energy_is_conserved():
    energy = energies(ArmPlant(parameters(**FRICTIONLESS)))
    assert energy[0] > 1.0
    np.testing.assert_allclose(energy, energy[0], rtol=1e-5)


def test_with_friction_and_damping_energy_only_falls():
    energy = energies(ArmPlant(parameters()))
    assert np.all(np.diff(energy) <= 1e-9)
    assert energy[-1] < 0.2 * energy[0]


def test_transmission_error_neither_makes_nor_loses_energy():
    """Its energy is that of the gear spring wound by twist and error together."""
    switches = {"amplitude": np.array([0.02]), "order": np.array([5.0]), "phase": np.array([0.7])}
    law = TransmissionError(np.array([0]), switches, "gear_spring")
    plant = ArmPlant(parameters(**FRICTIONLESS), [law])
    seen: list[float] = []

    def observe(k: int, state: np.ndarray) -> None:
        bent = state.copy()
        bent[0] += 0.02 * np.sin(5.0 * state[5] + 0.7)
        seen.append(plant.energy(bent)[0])

    plant.run(wound(plant), free_drive(1000), observe=observe)
    np.testing.assert_allclose(seen, seen[0], rtol=1e-4)


def test_momentum_grows_by_the_torque_alone():
    """The couplings act in pairs: without friction the total momentum is the integral of the torque."""
    plant = ArmPlant(parameters(**{**FRICTIONLESS, "d_g": 0.03, "d_a": 0.003}))
    torque = np.random.default_rng(1).normal(size=(500, 1))
    zero = np.zeros((500, 1))
    inertias = NOMINAL["J"] * np.array([NOMINAL["a_m"], NOMINAL["a_g"], 1.0 - NOMINAL["a_m"] - NOMINAL["a_g"]])
    momentum: list[float] = []
    plant.run(
        wound(plant),
        Drive(torque, zero, zero, np.zeros(1), np.zeros(1)),
        observe=lambda k, state: momentum.append(float(inertias @ state[2:5, 0])),
    )
    gained = np.array(momentum) - momentum[0]
    np.testing.assert_allclose(gained[1:], np.cumsum(torque)[:-1] * SAMPLE_TIME, atol=1e-9)


def test_smooth_plant_matches_an_adaptive_solver():
    """Against DOP853 at 1e-11, with the equations written out once more."""
    p = NOMINAL
    samples = 600
    torque = 3.0 * multisine(np.random.default_rng(3), samples, SAMPLE_TIME, 1.0, 40.0)

    def equations(time: float, x: np.ndarray, u: float) -> list[float]:
        gear, arm, motor_speed, gearbox_speed, arm_speed = x
        friction = p["F_v"] * motor_speed
        stribeck = p["F_cs"] / np.cosh(p["alpha"] * motor_speed)
        friction += (p["F_c"] + stribeck) * np.tanh(p["beta"] * motor_speed)
        gear_torque = p["k_g1"] * gear + p["k_g3"] * gear**3 + p["d_g"] * (motor_speed - gearbox_speed)
        arm_torque = p["k_a"] * arm + p["d_a"] * (gearbox_speed - arm_speed)
        return [
            motor_speed - gearbox_speed,
            gearbox_speed - arm_speed,
            (u - friction - gear_torque) / (p["J"] * p["a_m"]),
            (gear_torque - arm_torque) / (p["J"] * p["a_g"]),
            arm_torque / (p["J"] * (1.0 - p["a_m"] - p["a_g"])),
        ]

    plant = ArmPlant(parameters())
    state = wound(plant)
    x = state[:5, 0].copy()
    expected = []
    for u in torque:
        expected.append(x[2])
        x = solve_ivp(equations, (0.0, SAMPLE_TIME), x, method="DOP853", rtol=1e-11, atol=1e-12, args=(u,)).y[:, -1]
    drive = Drive(torque[:, None], np.zeros((samples, 1)), np.zeros((samples, 1)), np.zeros(1), np.zeros(1))
    simulated = plant.run(state, drive).speed[:, 0]
    np.testing.assert_allclose(simulated, expected, atol=1e-3)  # a fiftieth of the noise of the sensor


def test_lanes_do_not_disturb_each_other():
    several = {name: np.array([v, 0.9 * v, 0.8 * v]) for name, v in NOMINAL.items()}
    plant = ArmPlant(several)
    speeds = np.array([[3.0, 4.0, 5.0]] * 3)
    together = plant.run(plant.initial_state(speeds), free_drive(100, 3)).speed
    for lane in range(3):
        alone = ArmPlant({name: v[lane : lane + 1] for name, v in several.items()})
        speed = alone.run(alone.initial_state(speeds[:, lane : lane + 1]), free_drive(100)).speed
        np.testing.assert_allclose(speed[:, 0], together[:, lane], rtol=1e-12)


def test_feedback_is_recorded_with_the_noise_of_the_sensor():
    plant = ArmPlant(parameters())
    noise = 0.05 * np.random.default_rng(5).normal(size=(50, 1))
    reference = np.full((50, 1), 2.0)
    drive = Drive(np.zeros((50, 1)), reference, noise, np.array([0.6]), np.array([6.0]))
    recorded = plant.run(plant.initial_state(np.zeros((3, 1))), drive)
    error = (reference - recorded.speed)[:, 0]
    past = np.concatenate([[0.0], np.cumsum(error)[:-1]]) * SAMPLE_TIME
    np.testing.assert_allclose(recorded.torque[:, 0], 0.6 * error + 6.0 * past, atol=1e-12)


def test_overflow_is_said():
    plant = ArmPlant(parameters(k_g3=-1e5))
    with pytest.raises(FloatingPointError, match="lanes \\[0\\]"):
        plant.run(wound(plant), free_drive(2000))
    assert np.isnan(plant.run(wound(plant), free_drive(2000), overflow=True).speed[-1, 0])
