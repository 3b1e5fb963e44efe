"""Are the standard deviations that a fit reports true? Simulated repeats of the published problem of the robot arm say.

The optimum of the published problem is simulated again and again with fresh white noise of the residual's size, each repeat is fitted,
and the scatter of the estimates is held against σ² (JᵀJ)⁻¹, for the seven parameters and the three initial speeds.

    python -m experiments.monte_carlo_deviations ../shared/recordings/robot_arm/dataset.toml --repeats 200
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from greybox_torch import load_dataset, load_model
from greybox_torch.estimate import Problem, fit_records, make_problem, simulate
from greybox_torch.simulation import Simulator

ALLOWED = 0.2
"""Largest difference between scatter and reported deviation, as a share of the latter."""


def main() -> int:
    arguments = _parsed()
    data = load_dataset(arguments.dataset)
    problem = make_problem(data, load_model(data.model or "robot_arm"), data.estimation())
    simulator = Simulator.of(problem.model, problem.free_names)
    began = time.perf_counter()
    found = fit_records(problem, simulator=simulator)
    optimum, sigma = found.problem, np.sqrt(found.mse * found.samples / (found.samples - _unknowns(found.problem)))
    print(f"optimum: mean squared error {found.mse:.5f}, noise of the repeats {sigma:.4f}, {found.samples} samples")

    exact = np.concatenate(simulate(optimum, simulator.with_substeps(found.substeps))).T
    rng = np.random.default_rng(arguments.seed)
    estimates, reported = [], []
    for repeat in range(arguments.repeats):
        noisy = np.where(np.isnan(problem.records.y), np.nan, exact + rng.normal(0.0, sigma, exact.shape))
        again = fit_records(replace(optimum, records=replace(optimum.records, y=noisy)), simulator=simulator)
        assert again.uncertainty is not None
        estimates.append(_vector(again.problem))
        reported.append(again.uncertainty.deviations())
        if sys.stderr.isatty():
            print(f"\rrepeat {repeat + 1} of {arguments.repeats}", end="", file=sys.stderr)
    assert found.uncertainty is not None
    return _report(_names(optimum), found.uncertainty.deviations(), np.array(estimates), np.array(reported), began)


def _report(names: list[str], claimed: np.ndarray, estimates: np.ndarray, reported: np.ndarray, began: float) -> int:
    scatter = estimates.std(axis=0, ddof=1)
    ratio = scatter / claimed
    chance = 1 / np.sqrt(2 * (len(estimates) - 1))  # relative standard deviation of a scatter from so many repeats
    print(
        f"\n{len(estimates)} repeats in {time.perf_counter() - began:.0f} s; a scatter is known to ± {100 * chance:.0f} %\n"
    )
    print(f"{'':30}{'reported':>12}{'mean over repeats':>20}{'scatter':>12}{'ratio':>8}")
    for name, *row in zip(names, claimed, reported.mean(axis=0), scatter, ratio, strict=True):
        print(f"{name:30}{row[0]:12.5g}{row[1]:20.5g}{row[2]:12.5g}{row[3]:8.3f}")
    worst = float(np.abs(ratio - 1.0).max())
    verdict = "within" if worst <= ALLOWED else "NOT within"
    print(f"\nlargest difference {100 * worst:.1f} %: {verdict} {100 * ALLOWED:.0f} %")
    return 0 if worst <= ALLOWED else 1


def _unknowns(problem: Problem) -> int:
    return len(_vector(problem))


def _vector(problem: Problem) -> np.ndarray:
    return np.concatenate([problem.values[problem.free], problem.initial[:, problem.initial_free].ravel()])


def _names(problem: Problem) -> list[str]:
    states = [problem.model.states[i].name for i in problem.free_states]
    starts = [f"{state} at the start" for _ in problem.records.first for state in states]
    return [*problem.free_names, *starts]


def _parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path, help="the card of the arm's recordings")
    parser.add_argument("--repeats", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
