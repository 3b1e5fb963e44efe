"""Standard deviations against the scatter of simulated repeats."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from greybox_torch.estimate.fit import fit_records
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import Simulator
from tests.estimate.bench_motor import UNITS, problem_of


def test_standard_deviations_by_monte_carlo(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    """Estimates from 150 simulated repeats scatter as every one of them says."""
    rng = np.random.default_rng(3)
    exact = problem_of(data_set(UNITS, experiments), motor)
    exact = exact.with_values(np.array([0.02, 0.1, 0.05]), np.array([[2.0], [-1.0]]))
    simulator = Simulator.of(motor, exact.free_names)
    estimates, claims = [], {"plain": [], "sandwich": []}
    for _ in range(150):
        y = exact.records.y + rng.normal(0, 0.2, exact.records.y.shape)
        found = fit_records(replace(exact, records=replace(exact.records, y=y)), simulator=simulator)
        estimates.append([*found.problem.values[[0, 2]], *found.problem.initial[:, 0]])
        for kind, rows in claims.items():
            rows.append([*found.parameter_deviations(kind).values(), *found.initial_deviations(kind)[:, 0]])
    scatter = np.std(estimates, axis=0, ddof=1)
    np.testing.assert_allclose(np.mean(claims["plain"], axis=0), scatter, rtol=0.2)
    np.testing.assert_allclose(np.mean(claims["sandwich"], axis=0), scatter, rtol=0.35)
    np.testing.assert_allclose(
        np.mean(estimates, axis=0), [0.02, 0.05, 2.0, -1.0], atol=4 * scatter.max() / np.sqrt(150)
    )


def test_the_sandwich_allows_for_coloured_noise(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    """Where the errors are coloured the plain deviations are far too sure. (Blocks must be longer than the errors remember.)"""
    rng = np.random.default_rng(4)
    exact = problem_of(data_set(UNITS, experiments[:1]), motor)
    exact = exact.with_values(np.array([0.02, 0.1, 0.05]), np.array([[2.0]]))
    simulator = Simulator.of(motor, exact.free_names)
    estimates, plain, sandwich = [], [], []
    for _ in range(60):
        slow = np.convolve(rng.normal(0, 0.2, 400 + 5), np.ones(6) / np.sqrt(6), mode="valid")
        found = fit_records(
            replace(exact, records=replace(exact.records, y=exact.records.y + slow)), simulator=simulator
        )
        estimates.append(found.problem.values[2])
        plain.append(found.parameter_deviations()["b"])
        sandwich.append(found.parameter_deviations("sandwich")["b"])
    scatter = np.std(estimates, ddof=1)
    assert np.mean(plain) < 0.55 * scatter
    assert 0.65 * scatter < np.mean(sandwich) < 1.35 * scatter
