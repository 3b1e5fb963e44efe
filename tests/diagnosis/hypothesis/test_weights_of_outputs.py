"""Whole records of several outputs, each weighed by what the model leaves of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis import weights_of_outputs as module
from greybox_torch.estimate.levenberg_marquardt import Quadratic, Settings

RNG = np.random.default_rng(3)
COLUMNS = RNG.normal(size=(200, 2, 3))
TRUE, LEFT = np.array([1.0, -2.0, 0.5]), np.array([0.1, 30.0])
MEASURED = COLUMNS @ TRUE * np.array([1.0, 100.0]) + RNG.normal(size=(200, 2)) * LEFT


@dataclass(frozen=True)
class Records:
    y: np.ndarray = field(default_factory=lambda: MEASURED.T)


@dataclass(frozen=True)
class Problem:
    weights: np.ndarray
    values: np.ndarray
    records: Records = Records()


@dataclass(frozen=True)
class Linear:
    """Two outputs that are linear in three parameters, the second a hundred times as large, with the interface of a free run."""

    problem: Any
    simulator: Any = None

    @property
    def start(self) -> np.ndarray:
        return self.problem.values

    bounds, admissible = (np.full(3, -np.inf), np.full(3, np.inf)), staticmethod(lambda z: True)

    def at(self, z: np.ndarray) -> Problem:
        return Problem(self.problem.weights, z)

    def errors(self, z: np.ndarray) -> list:
        """Both are zero where the measurement is missing."""
        known = ~np.isnan(self.problem.records.y.T)
        slopes = COLUMNS * np.array([1.0, 100.0])[:, None] * (self.problem.weights * known)[:, :, None]
        return [(np.where(known, MEASURED, 0.0) * self.problem.weights - slopes @ z, slopes)]

    def quadratic(self, z: np.ndarray) -> Quadratic:
        ((errors, slopes),) = self.errors(z)
        flat = slopes.reshape(-1, 3)
        return Quadratic(0.5 * float((errors**2).sum()), -flat.T @ errors.ravel(), flat.T @ flat, None)


def solved(weights: np.ndarray) -> np.ndarray:
    """The least-squares parameters with the outputs' weights (2,)."""
    slopes = (COLUMNS * (np.array([1.0, 100.0]) * weights)[:, None]).reshape(-1, 3)
    return np.linalg.lstsq(slopes, (MEASURED * weights).ravel(), rcond=None)[0]


@pytest.mark.parametrize("wrong", [np.array([1.0, 1.0]), np.array([1e-3, 1.0]), np.array([0.1, 10.0])])
def test_weights_become_what_is_left_of_each_output(wrong) -> None:
    run, point = module.weighed_by_what_is_left(Linear(Problem(wrong, solved(wrong))), solved(wrong), Settings())
    np.testing.assert_allclose(point, solved(1.0 / LEFT), atol=2e-3)
    assert np.abs(point - TRUE).max() < np.abs(solved(wrong) - TRUE).max()
    np.testing.assert_allclose(run.problem.weights[0] / run.problem.weights[1], LEFT[1] / LEFT[0], rtol=0.5)


def test_where_nothing_is_estimated_or_one_output_is_measured_nothing_is_weighed() -> None:
    for run, point in ((Linear(Problem(LEFT, np.zeros(0))), np.zeros(0)), (Linear(Problem(LEFT[:1], TRUE)), TRUE)):
        assert module.weighed_by_what_is_left(run, point, Settings()) == (run, point)


def test_what_was_not_measured_is_no_error_of_zero() -> None:
    rare = MEASURED.T.copy()
    rare[1, np.arange(200) % 10 > 0] = np.nan
    run: Any = Linear(Problem(1.0 / LEFT, TRUE, Records(rare)))
    np.testing.assert_allclose(module._left(run, TRUE), LEFT, rtol=0.4)


def test_an_output_that_never_moves_does_not_judge() -> None:
    after, before, spread = np.array([0.5, 1.0]), np.array([1.0, 1.0]), np.array([10.0, 0.0])
    assert module._better(after, before, spread) and not module._better(2 * after, before, spread)


def test_weights_that_are_about_right_stand() -> None:
    begun = Linear(Problem(1.2 / LEFT, solved(1.2 / LEFT)))
    run, point = module.weighed_by_what_is_left(begun, begun.start, Settings())
    assert run is begun and point is begun.start


@pytest.mark.parametrize(
    ("after", "better"),
    [((0.5, 1.0), True), ((0.999, 1.0), False), ((0.01, 9.0), False)],
    ids=["less of one", "next to no less", "one to its noise, the other lost"],
)
def test_another_round_stands_where_it_follows_the_outputs_better(after, better) -> None:
    assert module._better(np.array(after), np.array([1.0, 1.0]), np.array([10.0, 10.0])) is better
