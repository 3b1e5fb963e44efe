"""Physics with an edge in the arm: dry friction that sticks, impacts in the gear's play."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from experiments.concealed.laws import Law, body, coupling, dry
from experiments.concealed.plant_arm import NOMINAL, ArmPlant, Drive, Recordings

SAMPLE_TIME = 0.001


def make(law: type[Law], port: str, **switches: float) -> Any:
    return law(np.array([0]), {name: np.array([value]) for name, value in switches.items()}, port)


def simulate(laws: list[Law], torque: np.ndarray, steps: int = 8, **changes: float) -> tuple[Recordings, np.ndarray]:
    """Open loop from rest; recordings and the states (samples, rows)."""
    parameters = {name: np.array([value]) for name, value in {**NOMINAL, **changes}.items()}
    plant = ArmPlant(parameters, laws, sample_time=SAMPLE_TIME, steps_per_sample=steps)
    zero, seen = np.zeros((len(torque), 1)), []
    run = plant.run(
        plant.initial_state(np.zeros((3, 1))),
        Drive(torque[:, None], zero, zero, np.zeros(1), np.zeros(1)),
        observe=lambda k, state: seen.append(state[:, 0].copy()),
    )
    return run, np.array(seen)


def test_an_arm_held_by_dry_friction_does_not_move_while_its_spring_winds():
    torque = np.full(300, 2.0)
    _, stuck = simulate([make(dry.DryCoulomb, "arm", level=3.0)], torque)
    assert np.all(stuck[:, 4] == 0.0)
    assert np.abs(stuck[:, 1]).max() > 0.02  # rad: gearbox against arm
    _, slipping = simulate([make(dry.DryCoulomb, "arm", level=0.1)], torque)
    assert slipping[-1, 4] > 1.0


def test_smooth_friction_comes_ever_closer_to_dry_friction():
    torque = 4.0 * np.sin(2.0 * np.pi * 3.0 * np.arange(350) * SAMPLE_TIME)
    sharp = simulate([make(dry.DryCoulomb, "arm", level=0.4)], torque, steps=32)[1][:, 4]
    wide, narrow = (
        simulate([make(body.Coulomb, "arm", level=0.4, v_0=width)], torque, steps=32)[1][:, 4] for width in (0.5, 0.05)
    )
    assert np.abs(narrow - sharp).max() < 0.3 * np.abs(wide - sharp).max()
    assert np.abs(narrow - sharp).max() < 0.1


def test_gear_with_impacts_matches_an_adaptive_solver():
    """DOP853 with steps too short to miss a flank; the damper works in contact alone."""
    p, gap = {**NOMINAL, "F_cs": 0.0}, 0.03
    torque = 2.0 * np.sign(np.sin(2.0 * np.pi * 4.0 * np.arange(300) * SAMPLE_TIME + 0.1))

    def equations(time: float, x: np.ndarray, u: float) -> list[float]:
        twist = x[0] - np.clip(x[0], -gap, gap)
        rate = (x[2] - x[3]) * (abs(x[0]) > gap)
        gear = p["k_g1"] * twist + p["k_g3"] * twist**3 + p["d_g"] * rate
        arm = p["k_a"] * x[1] + p["d_a"] * (x[3] - x[4])
        friction = p["F_v"] * x[2] + p["F_c"] * np.tanh(p["beta"] * x[2])
        third = 1.0 - p["a_m"] - p["a_g"]
        speeds = ((u - friction - gear) / p["a_m"], (gear - arm) / p["a_g"], arm / third)
        return [x[2] - x[3], x[3] - x[4], *(s / p["J"] for s in speeds)]

    x, expected = np.zeros(5), []
    for u in torque:
        expected.append(x[2])
        solved = solve_ivp(
            equations, (0.0, SAMPLE_TIME), x, "DOP853", rtol=1e-9, atol=1e-11, max_step=SAMPLE_TIME / 4, args=(u,)
        )
        x = solved.y[:, -1]
    run, states = simulate([make(coupling.BacklashWithImpacts, "gear_spring", half_gap=gap)], torque, F_cs=0.0)
    assert np.abs(states[:, 0]).max() > gap + 0.02 and (np.diff(np.abs(states[:, 0]) > gap) != 0).sum() > 3
    np.testing.assert_allclose(run.speed[:, 0], expected, atol=0.05)


def test_nothing_is_transmitted_in_the_gap():
    free = make(coupling.BacklashWithImpacts, "gear_spring", half_gap=10.0)
    _, states = simulate([free], np.full(50, 1.0))
    assert np.all(states[:, 3] == 0.0)
    assert states[-1, 2] > 1.0
