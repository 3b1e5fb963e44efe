"""Linear answers of a screen: against least squares, and beside parameters that are at their bounds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.screen.linear_answer import LinearAnswer


@pytest.fixture
def columns() -> np.ndarray:
    """Two parameters' columns, of which the second and a direction are nearly alike; the direction's, and a residual that is it."""
    rng = np.random.default_rng(4)
    a, b, apart = rng.normal(size=(3, 200))
    direction = b + 0.05 * apart
    return np.stack([a, b, direction, 0.3 * a - 0.7 * direction], axis=1)


def answer(stub: Any, columns: np.ndarray, values: tuple[float, float], lower: tuple[float, float]) -> LinearAnswer:
    free = np.array([True, True])
    problem = stub(free=free, values=np.array(values), lower=np.array(lower), upper=np.full(2, 10.0))
    return LinearAnswer.of(columns.T @ columns, stub(problem=problem, mean_square=1e-12))


def test_inside_the_bounds_it_is_least_squares(stub, columns) -> None:
    got = answer(stub, columns, (1.0, 1.0), (-10.0, -10.0))
    base, residual = columns[:, :2], columns[:, -1]
    alone = residual - base @ np.linalg.lstsq(base, residual, rcond=None)[0]
    assert got.beside_parameters(np.arange(0))[1] == pytest.approx(alone @ alone, rel=1e-6)
    size, left = got.beside_parameters(np.array([2]))
    assert size == pytest.approx([-0.7], rel=1e-4) and left < 1e-6 * (alone @ alone)


def test_a_parameter_at_its_bound_takes_nothing_away_that_it_cannot_explain(stub, columns) -> None:
    """The residual asks for less of the second parameter, which is as small as it may be: the direction alone can explain it."""
    inside, at_bound = (answer(stub, columns, (1.0, 0.0), (-10.0, least)) for least in (-10.0, 0.0))
    explained = [
        a.beside_parameters(np.arange(0))[1] - a.beside_parameters(np.array([2]))[1] for a in (inside, at_bound)
    ]
    assert explained[1] > 100 * explained[0]
    residual = columns[:, -1]
    only = columns[:, :1] @ np.linalg.lstsq(columns[:, :1], residual, rcond=None)[0]
    assert at_bound.beside_parameters(np.arange(0))[1] == pytest.approx(np.sum((residual - only) ** 2), rel=1e-6)
    assert at_bound.beside_parameters(np.array([2]))[0] == pytest.approx([-0.7], rel=1e-4)


def test_away_from_its_bound_it_moves_as_ever(stub, columns) -> None:
    """The residual asks for more of the second parameter."""
    turned = columns * np.array([1.0, 1.0, 1.0, -1.0])
    inside, at_bound = (answer(stub, turned, (1.0, 0.0), (-10.0, least)) for least in (-10.0, 0.0))
    for directions in (np.arange(0), np.array([2])):
        (one, left), (other, also_left) = (a.beside_parameters(directions) for a in (inside, at_bound))
        assert one == pytest.approx(other) and left == pytest.approx(also_left, rel=1e-9, abs=1e-12)
