"""The step within bounds, against SciPy's bounded least squares."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from greybox_torch.estimate.bounded_step import bounded_step


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 9), width=st.floats(0.01, 3.0))
def test_is_the_minimum_within_the_bounds(seed: int, count: int, width: float) -> None:
    draw = np.random.default_rng(seed)
    jacobian, errors = draw.normal(size=(count + 4, count)), draw.normal(size=count + 4)
    low, high = -width * draw.uniform(0, 1, count), width * draw.uniform(0, 1, count)
    found = bounded_step(jacobian.T @ jacobian, jacobian.T @ errors, low, high)
    wanted = lsq_linear(jacobian, errors, (low, high), method="bvls", tol=1e-12).x
    assert found == pytest.approx(wanted, abs=1e-7)


def test_cutting_off_the_free_minimum_would_be_wrong() -> None:
    """Two unknowns that make up for one another: with one stopped at 0, the other's best step changes its sign."""
    matrix, right = np.array([[1.0, 0.95], [0.95, 1.0]]), np.array([1.0, 0.9])
    free = np.linalg.solve(matrix, right)
    assert free[1] < 0 < free[0]
    step = bounded_step(matrix, right, np.array([-9.0, 0.0]), np.array([9.0, 9.0]))
    assert step == pytest.approx([1.0, 0.0])


def test_unknowns_at_their_bounds_may_leave_them() -> None:
    assert bounded_step(np.eye(2), np.array([1.0, -1.0]), np.zeros(2), np.ones(2)) == pytest.approx([1.0, 0.0])


def test_without_bounds_and_without_unknowns() -> None:
    matrix, right = np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([1.0, -3.0])
    far = np.full(2, np.inf)
    assert bounded_step(matrix, right, -far, far) == pytest.approx(np.linalg.solve(matrix, right))
    assert bounded_step(np.zeros((0, 0)), np.zeros(0), np.zeros(0), np.zeros(0)).shape == (0,)
