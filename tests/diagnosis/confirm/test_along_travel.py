"""Where positions that no sensor shows begin, as free runs have it."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.along_travel import begun_along_travel
from greybox_torch.diagnosis.hypothesis.fit import augmented
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.problem import problem_for
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.simulation.simulator import Simulator

BEGINS = 0.4
"""Position at which the simulated motor begins, rad."""

WHERE, STIFFNESS = 0.6, 2.0


def stopped(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    return -STIFFNESS * np.maximum(q - WHERE, 0.0)


def restated(search, effect, **values):
    model = augmented(search.problem, (effect,), search.surroundings)
    own = {f"{effect.prefix}.{n}": v for n, v in values.items()}
    problem = problem_for(search.problem, model, {**search.problem.model.values(), "J": 0.02, "b": 0.05, **own})
    return problem.fixed, Simulator.of(model)


@pytest.fixture
def at_the_stop(motor_data, motor, begun):
    search = begun(motor_data(torque=stopped), motor)
    stop = attach(motor, "rotor", EndStop())
    return restated(search, stop, k=STIFFNESS, where=WHERE, c=0.0, side=1.0)


def test_a_stop_is_hit_where_it_was(at_the_stop) -> None:
    """Seen: an arm's stop, hit in a few windows of one experiment, was placed 6 rad away there; its free run left 275 times the noise."""
    problem, simulator = at_the_stop
    position = [s.name for s in problem.model.states].index("rotor.position")
    rows = estimate_initial(problem, simulator).initial.copy()
    rows[0, position] = BEGINS - 5.0
    far = problem.with_values(problem.values, rows)
    found = begun_along_travel(far, simulator, [0])
    assert found.initial[0, position] == pytest.approx(BEGINS, abs=0.02)
    assert np.delete(found.initial[0], position) == pytest.approx(np.delete(rows[0], position))
    again = begun_along_travel(found, simulator, [0])
    assert again.initial[0, position] == pytest.approx(BEGINS, abs=0.02)
    assert begun_along_travel(far, simulator, []).initial == pytest.approx(rows), "experiments that are not asked stay"


def test_without_such_a_position_nothing_is_moved(motor_data, motor, begun) -> None:
    search = begun(motor_data(torque=lambda q, v: 0.05), motor)
    problem, simulator = restated(search, attach(motor, "rotor", ConstantBias()), bias=0.05)
    assert begun_along_travel(problem, simulator, [0]) is problem
