from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from greybox_torch.estimate.levenberg_marquardt import Quadratic, Settings, _part_of, minimise
from greybox_torch.estimate.termination import Termination

OPEN = np.full(2, np.inf)


def of_residuals(
    residuals: Callable[[np.ndarray], np.ndarray], jacobian: Callable[[np.ndarray], np.ndarray]
) -> Callable[[np.ndarray], Quadratic[None]]:
    def evaluate(z: np.ndarray) -> Quadratic[None]:
        r, j = residuals(z), jacobian(z)
        return Quadratic(0.5 * float(r @ r), j.T @ r, j.T @ j, None)

    return evaluate


rosenbrock = of_residuals(
    lambda z: np.array([10 * (z[1] - z[0] ** 2), 1 - z[0]]), lambda z: np.array([[-20 * z[0], 10.0], [-1.0, 0.0]])
)


def test_rosenbrock() -> None:
    costs: list[float] = []
    found = minimise(
        rosenbrock, np.array([-1.2, 1.0]), -OPEN, OPEN, on_iteration=lambda i, cost, damping: costs.append(cost)
    )
    assert found is not None
    assert found.termination in (Termination.converged, Termination.small_step)
    np.testing.assert_allclose(found.point, [1.0, 1.0], atol=1e-6)
    assert costs == sorted(costs, reverse=True)
    assert found.evaluations >= found.iterations >= len(costs) > 5


def test_linear_least_squares_in_badly_scaled_unknowns() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.standard_normal((30, 4)) * [1e-6, 1.0, 1e3, 1e5], rng.standard_normal(30)
    found = minimise(
        of_residuals(lambda z: a @ z - b, lambda z: a), np.zeros(4), np.full(4, -np.inf), np.full(4, np.inf)
    )
    assert found is not None
    np.testing.assert_allclose(found.point, np.linalg.lstsq(a, b, rcond=None)[0], rtol=1e-4)


@pytest.mark.parametrize("units", [2.0**-140, 2.0**-40, 2.0**20, 2.0**100])
def test_the_descent_is_the_same_in_any_units(units: float) -> None:
    """Seen: a belt's stiffness by the cube of a deflection in m, whose optimum was never reached: its curvature is 1e-22 of the others'."""
    scale = np.array([1.0, units])
    own = minimise(rosenbrock, np.array([-1.2, 1.0]), -OPEN, OPEN)

    def evaluate(z: np.ndarray) -> Quadratic[None]:
        found = rosenbrock(z / scale)
        return Quadratic(found.cost, found.gradient / scale, found.hessian / np.outer(scale, scale), None)

    other = minimise(evaluate, np.array([-1.2, units]), -OPEN, OPEN)
    assert own is not None and other is not None and other.iterations == own.iterations
    np.testing.assert_allclose(other.point / scale, own.point, rtol=1e-6)


def test_optimum_at_a_bound() -> None:
    """Within z0 ≤ 0.5 the valley's lowest point is on the bound, at z1 = z0²."""
    found = minimise(rosenbrock, np.array([-1.2, 1.0]), -OPEN, np.array([0.5, np.inf]))
    assert found is not None
    np.testing.assert_allclose(found.point, [0.5, 0.25], atol=1e-6)


def test_start_at_a_bound_leads_inwards() -> None:
    found = minimise(rosenbrock, np.array([0.0, 0.0]), np.zeros(2), OPEN)
    assert found is not None
    np.testing.assert_allclose(found.point, [1.0, 1.0], atol=1e-6)


def test_start_at_an_optimum_held_by_bounds() -> None:
    found = minimise(rosenbrock, np.array([0.5, 0.25]), -OPEN, np.array([0.5, 0.25]))
    assert found is not None
    assert found.point.tolist() == [0.5, 0.25]


def test_start_outside_the_bounds_is_brought_in() -> None:
    found = minimise(rosenbrock, np.array([9.0, 9.0]), -OPEN, np.array([0.5, np.inf]))
    assert found is not None
    assert found.point[0] <= 0.5


def test_points_that_fail_are_stepped_around() -> None:
    tried: list[bool] = []

    def fails_below(z: np.ndarray) -> Quadratic[None] | None:
        tried.append(z[1] < -0.3)  # where the first full step leads
        return None if tried[-1] else rosenbrock(z)

    found = minimise(fails_below, np.array([-1.2, 1.0]), -OPEN, OPEN)
    assert found is not None
    assert any(tried)
    np.testing.assert_allclose(found.point, [1.0, 1.0], atol=1e-5)


def test_joint_constraint() -> None:
    found = minimise(rosenbrock, np.array([-1.2, 1.0]), -OPEN, OPEN, admissible=lambda z: bool(z[0] + z[1] < 1.0))
    assert found is not None
    assert found.point.sum() < 1.0
    assert found.model.cost < rosenbrock(np.array([-1.2, 1.0])).cost


def test_start_that_fails() -> None:
    assert minimise(lambda z: None, np.zeros(2), -OPEN, OPEN) is None


def test_iteration_limit() -> None:
    found = minimise(rosenbrock, np.array([-1.2, 1.0]), -OPEN, OPEN, settings=Settings(iterations=2))
    assert found is not None
    assert found.termination is Termination.iteration_limit
    assert "go on from these values" in found.termination.value


def test_unknown_that_does_not_matter() -> None:
    evaluate = of_residuals(lambda z: np.array([z[0] - 3.0]), lambda z: np.array([[1.0, 0.0]]))
    found = minimise(evaluate, np.array([0.0, 7.0]), -OPEN, OPEN)
    assert found is not None
    assert found.point == pytest.approx([3.0, 7.0], abs=1e-6)


@pytest.mark.filterwarnings("error")
def test_a_gain_beyond_all_numbers_is_no_warning() -> None:
    """Seen: "RuntimeWarning: overflow encountered in scalar divide" of a simulation from Python."""
    assert _part_of(1e10, 1e-300) == np.inf and _part_of(1.0, 2.0) == 0.5


def test_an_unknown_that_moves_nothing_stays_where_it_is() -> None:
    """Seen: the heading of a boat without a compass, on which nothing depends, was estimated at -5e86 rad by rounding errors."""
    rng = np.random.default_rng(0)
    a, b = rng.standard_normal((30, 6)), rng.standard_normal(30)
    a[:, 2] = 0.0
    bend = of_residuals(lambda z: a @ z + 0.1 * (a @ z) ** 2 - b, lambda z: a * (1.0 + 0.2 * (a @ z))[:, None])
    found = minimise(bend, np.full(6, 0.25), np.full(6, -np.inf), np.full(6, np.inf))
    assert found is not None
    assert found.point[2] == 0.25
    assert (found.point[[0, 1, 3, 4, 5]] != 0.25).all()
