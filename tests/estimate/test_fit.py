"""Estimation on the documentation's motor, whose exact response is known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greybox_torch.errors import NumericalError
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.termination import Termination
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import load_model
from tests.estimate.bench_motor import NAN, TRUTH, UNITS, Runaway, noisy, problem_of, values


def test_recovers_the_parameters(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    lines: list[tuple[str, int, float]] = []
    found = fit_records(problem_of(data_set(UNITS, experiments), motor), progress=lambda *line: lines.append(line))
    assert found.termination in (Termination.converged, Termination.small_step)
    assert values(found) == pytest.approx(TRUTH, rel=1e-5)
    np.testing.assert_allclose(found.problem.initial[:, 0], [2.0, -1.0], atol=1e-4)
    assert found.mse < 1e-8
    assert found.samples == 640
    assert [mse for *_, mse in lines] == sorted((mse for *_, mse in lines), reverse=True)
    assert [i for _, i, _ in lines] == list(range(1, len(lines) + 1))
    assert found.evaluations >= found.iterations >= len(lines) > 2


def test_recovers_the_parameters_from_far_off(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, parameters={"J": {"value": 1.0}, "b": {"value": 2.0}})
    assert values(fit_records(problem_of(data, motor))) == pytest.approx(TRUTH, rel=1e-4)


def test_fixed_parameters_stay(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    found = fit_records(
        problem_of(data_set(UNITS, experiments, parameters={"b": {"value": 0.06, "fixed": True}}), motor)
    )
    assert values(found)["b"] == 0.06
    assert values(found)["k"] == 0.1
    assert list(found.parameter_deviations()) == ["J"]


def test_bounds_are_kept(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, parameters={"J": {"value": 0.04, "lower": 0.03, "upper": 0.05}})
    found = fit_records(problem_of(data, motor))
    assert found.termination in (Termination.converged, Termination.small_step)
    assert values(found)["J"] == 0.03
    free_J = data_set(UNITS, experiments, parameters={"J": {"value": 0.03, "fixed": True}})
    assert values(found)["b"] == pytest.approx(values(fit_records(problem_of(free_J, motor)))["b"], rel=1e-6)


def test_fixed_start_states_stay(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    found = fit_records(
        problem_of(data_set(UNITS, experiments, initial={"speed": {"value": 0.5, "fixed": True}}), motor)
    )
    assert found.problem.initial.tolist() == [[0.5], [0.5]]
    assert found.initial_deviations().tolist() == [[0.0], [0.0]]


def test_start_states_of_the_card(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, initial={"speed": {"value": 0.5}})
    assert problem_of(data, motor).initial.tolist() == [[0.5], [0.5]]
    assert fit_records(problem_of(data, motor)).problem.initial[:, 0] == pytest.approx([2.0, -1.0], abs=1e-4)


def test_nothing_free(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    fixed = {"fixed": True}
    data = data_set(UNITS, experiments, parameters={"J": fixed, "b": fixed}, initial={"speed": {"value": 0.0, **fixed}})
    found = fit_records(problem_of(data, motor))
    assert found.termination is Termination.nothing_free
    assert found.mse == found.fpe > 0
    assert (found.parameter_deviations(), found.uncertainty) == ({}, None)


def test_missing_samples_carry_no_weight(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    """Whatever stood where samples are missing, the estimate is that of the others."""
    holes = np.random.default_rng(5).random(400) < 0.4
    holes[:3] = True
    first = {**experiments[0], "speed": np.where(holes, NAN, experiments[0]["speed"])}
    found = fit_records(problem_of(data_set(UNITS, [first, experiments[1]]), motor))
    assert found.samples == 640 - holes.sum()
    assert values(found) == pytest.approx(TRUTH, rel=1e-5)


def test_final_prediction_error(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    found = fit_records(problem_of(data_set(UNITS, noisy(experiments)), motor))
    d, n = 2 + 2, 640  # J and b, and a start speed for each experiment
    assert found.mse == pytest.approx(0.01, rel=0.15)
    assert found.fpe == pytest.approx(found.mse * (1 + d / n) / (1 - d / n), rel=1e-12)


def test_parameters_that_only_matter_together(machines: Path, experiments: list[Any], data_set: Any) -> None:
    """With k free too, only J / k and b / k are determined: the deviations say so, and the fit is as good."""
    model = load_model(f"{machines / 'motor.py'}:Motor")
    found = fit_records(problem_of(data_set(UNITS, noisy(experiments), parameters={"k": {"fixed": False}}), model))
    assert set(found.parameter_deviations().values()) == {np.inf}
    assert values(found)["J"] / values(found)["k"] == pytest.approx(0.2, rel=0.05)
    assert np.isfinite(found.initial_deviations()).all()


def test_start_values_that_overflow(experiments: list[Any], data_set: Any) -> None:
    with pytest.raises(NumericalError, match=r"estimating Runaway: failed: the simulation overflows.*try"):
        fit_records(problem_of(data_set(UNITS, experiments), Runaway()))


def test_start_values_whose_long_simulation_overflows(data_set: Any) -> None:
    """Whole records overflow at the start value, short windows do not: the estimate is reached all the same."""
    decay = {"voltage": np.zeros(500), "speed": np.exp(-1.0 * 0.01 * np.arange(500))}
    problem = problem_of(data_set(UNITS, [decay], parameters={"a": {"value": 50.0}}), Runaway())
    assert float(fit_records(problem).problem.values[0]) == pytest.approx(-1.0, rel=1e-4)
