"""At every port of the arm, the parameters that act there and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from experiments.concealed.against.own_terms import own_columns
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.records import Records
from greybox_torch.systems import RobotArm

RNG = np.random.default_rng(0)
STATES = RNG.standard_normal((40, 5)) * [0.1, 0.1, 5.0, 5.0, 5.0]
TORQUE = RNG.standard_normal((1, 40))


@pytest.fixture
def problem() -> Problem:
    model = RobotArm()
    parameters = model.declared_parameters
    records = Records(
        TORQUE, np.zeros((1, 40)), np.full(40, 1e-3), np.array([0]), np.array([39]), ("one",), "zoh"
    )  # fmt: skip
    size = len(parameters)
    values = np.array([p.value for p in parameters])
    free = np.array([p.name != "J" for p in parameters])
    unbounded = np.full(size, np.inf)
    return Problem(
        model, records, tuple(p.name for p in parameters), values, -unbounded, unbounded, free, np.zeros((1, 5)),
        np.ones(5, dtype=bool), np.ones(1), np.zeros(5, dtype=bool), values,
    )  # fmt: skip


def explained(columns: np.ndarray, target: np.ndarray) -> float:
    """Share of a target that columns explain."""
    left = target - columns @ np.linalg.lstsq(columns, target, rcond=None)[0]
    return 1.0 - float((left**2).sum() / (target**2).sum())


@pytest.mark.parametrize(
    ("port", "count", "terms"),
    [
        ("motor", 5, [STATES[:, 2], np.tanh(0.79943497008153 * STATES[:, 2])]),
        ("actuator", 5, [STATES[:, 2]]),
        ("gear_spring", 3, [STATES[:, 0], STATES[:, 0] ** 3, STATES[:, 2] - STATES[:, 3]]),
        ("arm_spring", 2, [STATES[:, 1], STATES[:, 3] - STATES[:, 4]]),
    ],
)
def test_columns_are_what_the_parameters_do(problem: Problem, port: str, count: int, terms: list[np.ndarray]) -> None:
    columns = own_columns(problem, port, STATES)
    assert columns.shape == (40, count)
    for term in terms:
        assert explained(columns, term) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("port", ["gearbox", "arm"])
def test_bodies_without_parameters_of_their_own_have_no_columns(problem: Problem, port: str) -> None:
    assert own_columns(problem, port, STATES).shape == (40, 0)
