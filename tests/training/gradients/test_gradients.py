"""The three gradients against differences of their own loss, and against one another, in float64."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.simulation.windows import Windows
from greybox_torch.training.gradients import GRADIENTS, Batch, make_gradient
from greybox_torch.training.gradients.recomputation import RecomputationGradient
from tests.cuda import needs_cuda


@pytest.fixture(scope="module")
def problem(table_hybrid) -> Problem:
    return table_hybrid.problem


@pytest.fixture(scope="module")
def batch(problem) -> Batch:
    """Windows of two lengths in two experiments, with missing samples, a warm-up, and one that ends with its experiment."""
    start, last = np.array([13, 200, 1590, 1695]), np.array([26, 210, 1599, 1708])
    y = problem.records.y.copy()
    y[0, [15, 16, 205, 1700, 1701]] = np.nan
    windows = Windows(start, last, int((last - start).max()) + 1)
    return Batch(replace(problem.records, y=y), windows, problem.records.y[0, start][:, None] + 0.1)


def difference(gradient, values: np.ndarray, batch: Batch, direction: np.ndarray) -> float:
    """Central difference of the loss along a direction (n_p,)."""
    above, below = (gradient(values + h * direction, batch).energy for h in (1e-5, -1e-5))
    return (above - below) / 2e-5


@pytest.mark.parametrize("substeps", [1, 2])
@pytest.mark.parametrize("name", GRADIENTS)
def test_against_differences(name: str, substeps: int, problem, batch) -> None:
    simulator = Simulator.of(problem.model, problem.free_names, SimulationOptions(substeps=substeps))
    gradient = make_gradient(name, problem, simulator)
    found = gradient(problem.values, batch)
    assert found.slope.shape == (len(problem.free_names),)
    tolerance = 1e-3 if name == "odeint_adjoint" else 1e-7  # the adjoint is not of the steps but of the solution
    for part in ("", ".friction_net."):  # all parameters, and those of the network alone
        taken = np.where(
            problem.free & np.array([part in n for n in problem.names]), np.abs(problem.values) + 0.01, 0.0
        )
        expected = difference(gradient, problem.values, batch, taken)
        assert abs(expected) > 0.1
        assert found.slope @ taken[problem.free] == pytest.approx(expected, rel=tolerance)


def test_against_one_another(problem, batch) -> None:
    simulator = Simulator.of(problem.model, problem.free_names)
    tangents, recomputation, adjoint = (
        make_gradient(name, problem, simulator)(problem.values, batch) for name in GRADIENTS
    )
    assert recomputation.energy == pytest.approx(tangents.energy, rel=1e-12)
    np.testing.assert_allclose(recomputation.slope, tangents.slope, rtol=1e-9, atol=1e-10)
    assert adjoint.energy == pytest.approx(tangents.energy, rel=1e-5)  # its steps are of the 3/8 rule
    np.testing.assert_allclose(adjoint.slope, tangents.slope, rtol=1e-3, atol=1e-4 * np.abs(tangents.slope).max())


@needs_cuda
@pytest.mark.parametrize("name", GRADIENTS)
def test_on_a_graphics_processor(name: str, problem, batch) -> None:
    here, there = (
        make_gradient(name, problem, Simulator.of(problem.model, problem.free_names, SimulationOptions(device)))(
            problem.values, batch
        )
        for device in ("cpu", "cuda")
    )
    assert there.energy == pytest.approx(here.energy, rel=1e-9)
    np.testing.assert_allclose(there.slope, here.slope, rtol=1e-6, atol=1e-8 * np.abs(here.slope).max())


@pytest.mark.parametrize("chunk", [0, 1, 7, 1000])
def test_recomputation_changes_nothing(chunk: int, problem, batch) -> None:
    whole = RecomputationGradient(problem)(problem.values, batch)
    other = RecomputationGradient(problem, chunk=chunk)(problem.values, batch)
    assert other.energy == pytest.approx(whole.energy, rel=1e-13)
    np.testing.assert_allclose(other.slope, whole.slope, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("name", GRADIENTS)
def test_straight_lines_between_samples(name: str, problem, batch) -> None:
    foh = replace(problem, records=replace(problem.records, hold="foh"))
    other = replace(batch, records=replace(batch.records, hold="foh"))
    simulator = Simulator.of(problem.model, problem.free_names)
    found = make_gradient(name, foh, simulator)(problem.values, other)
    exact = make_gradient("tangents", foh, simulator)(problem.values, other)
    assert found.energy == pytest.approx(exact.energy, rel=1e-4)
    assert abs(exact.energy / make_gradient(name, problem, simulator)(problem.values, batch).energy - 1) > 1e-6


def test_samples_that_count(batch) -> None:
    assert batch.samples == 14 + 11 + 10 + 14 - 5


@pytest.mark.parametrize("name", GRADIENTS)
def test_overflow_is_a_value(name: str, problem, batch) -> None:
    values = problem.values.copy()
    values[problem.names.index("J")] = 1e-30
    with np.errstate(all="ignore"):
        found = make_gradient(name, problem, Simulator.of(problem.model, problem.free_names))(values, batch)
    assert not found.finite


def test_unknown_gradient(problem) -> None:
    with pytest.raises(
        UserError, match=r'gradient: found .tangent., unknown \(did you mean "tangents"\?\); expected one of'
    ):
        make_gradient("tangent", problem, Simulator.of(problem.model, ()))
