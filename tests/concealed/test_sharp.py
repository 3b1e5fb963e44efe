"""Physics with an edge in the arm: dry friction that sticks, impacts in the gear's play."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
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


def cell(law: type, **switches: float):
    """A law on one lane of a body of 1 kg on a rail, 1 ms; returns what advances the whole by one sample under a force."""
    from experiments.concealed.plant_body import BodyPlant

    one = law(np.arange(1), {name: np.full(1, float(value)) for name, value in switches.items()}, "carriage")
    plant = BodyPlant(np.ones(1), np.zeros(1), np.zeros(1), [one], sample_time=1e-3, steps_per_sample=10)
    return plant, lambda k, state, force: plant._advanced(k, state, np.tile(force, (k + 1, 1)).astype(float))


def test_friction_on_an_elastic_seat_gives_then_slides_at_its_level() -> None:
    plant, advance = cell(dry.DryPresliding, level=2.0, stiffness=2000.0, damping=20.0)
    state = plant.initial_state(np.zeros(1), np.zeros(1))
    for k in range(400):  # a force below the level: the seat gives by force / stiffness, and nothing slides
        state = advance(k, state, 1.0)
    assert state[0, 0] == pytest.approx(1.0 / 2000.0, rel=5e-3)
    for k in range(400):
        state = advance(k, state, 0.0)
    assert state[0, 0] == pytest.approx(0.0, abs=1e-5)  # and comes back
    state[1] = 0.5
    for k in range(100):  # sliding: the level is taken off, whatever the speed
        state = advance(k, state, 3.0)
    assert state[1, 0] == pytest.approx(0.5 + 0.1 * (3.0 - 2.0) - 20.0 * 0.001, abs=5e-3)  # less what the winding damps


def test_a_bristle_whose_level_falls_with_speed_slides_at_the_stribeck_curve() -> None:
    plant, advance = cell(body.StribeckBristle, level=2.0, extra=1.5, v_s=0.3, c=0.4, stiffness=4000.0, damping=5.0)
    for speed in (0.1, 1.0):
        state = plant.initial_state(np.zeros(1), np.full(1, speed))
        friction = 2.0 + 1.5 * np.exp(-((speed / 0.3) ** 2)) + 0.4 * speed
        for k in range(80):
            state[1] = speed  # held
            state = advance(k, state, 0.0)
        assert 1e3 * (speed - state[1, 0]) == pytest.approx(friction, rel=0.03)


def test_a_stop_that_is_hit_turns_the_speed_round() -> None:
    plant, advance = cell(dry.HardStop, limit=0.01, side=1.0, restitution=0.5)
    state = plant.initial_state(np.zeros(1), np.full(1, 1.0))
    seen = []
    for k in range(30):
        state = advance(k, state, 0.0)
        seen.append((state[0, 0], state[1, 0]))
    assert max(q for q, _ in seen) <= 0.01 + 1e-9
    assert seen[-1][1] == pytest.approx(-0.5)


def test_a_bouc_wen_loop_slips_at_its_torque_and_takes_energy() -> None:
    law = make(coupling.BoucWen, "gear_spring", **{"stiffness": 10.0, "yield": 0.03, "share": 0.7, "power": 2.0})
    torque = 4.0 * np.sin(2.0 * np.pi * 5.0 * np.arange(600) * SAMPLE_TIME)
    _, states = simulate([law], torque)
    z = states[:, 6]
    assert 0.02 < np.abs(z).max() < 0.03 * 1.01
    twist = states[:, 0]
    assert np.sum(0.5 * 10.0 * (z[1:] + z[:-1]) * np.diff(twist)) > 0.0
