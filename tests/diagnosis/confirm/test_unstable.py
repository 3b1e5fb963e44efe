"""Whether free runs can follow an experiment: how far two of them part that begin next to one another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.unstable import no_free_run_follows, parted
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem
from greybox_torch.simulation.simulator import SimulationOptions, Simulator

SETTINGS = DiagnosisSettings(unseen_start=1e-4)


@pytest.fixture(scope="module")
def friction(motor_data, motor):
    """The motor, two experiments of 5 s, with a friction that slows it down, or drives it."""

    def of(b: float, start: float = 0.3) -> tuple[Problem, Simulator]:
        data = motor_data(500, ("estimation", "validation"))
        problem = all_starts_free(data, make_problem(data, motor, data.recordings))
        values = np.array([{"J": 0.02, "k": 0.1, "b": b}[name] for name in problem.names])
        simulator = Simulator.of(motor, (), SimulationOptions(substeps=4))
        return problem.with_values(values, np.full_like(problem.initial, start)), simulator

    return of


@pytest.mark.parametrize("b", [0.05, -0.02, -0.05])
def test_as_far_as_the_closed_form_says(friction, b: float) -> None:
    """A change δ of the start grows as δ exp(-b t / J)."""
    problem, simulator = friction(b)
    names = list(problem.records.names)
    span = problem.records.span(1)
    time = problem.records.time(1)
    speed, voltage = np.empty(len(time)), problem.records.u[0, span]
    speed[0], decay = 0.3, np.exp(-b * 0.01 / 0.02)
    for k in range(len(time) - 1):
        speed[k + 1] = decay * speed[k] + (1 - decay) * 0.1 * voltage[k] / b
    error = np.sqrt(np.mean((speed - problem.records.y[0, span]) ** 2))
    moved = 1e-4 * np.ptp(speed) * np.sqrt(np.mean(np.exp(-2 * b * (time - time[0]) / 0.02)))
    assert parted(problem, simulator, names[1:], SETTINGS) == {names[1]: pytest.approx(moved / error, rel=1e-5)}


def test_a_run_that_overflows_is_the_models_fault(friction) -> None:
    problem, simulator = friction(-10.0)
    assert list(parted(problem, simulator, problem.records.names, SETTINGS).values()) == [0.0, 0.0]


def test_samples_that_are_missing_do_not_count(friction) -> None:
    problem, simulator = friction(0.05)
    records = problem.records
    y = records.y.copy()
    y[:, records.first[1] + 7] = np.nan
    name = records.names[1]
    whole, part = (
        parted(p, simulator, [name], SETTINGS)[name] for p in (problem, replace(problem, records=replace(records, y=y)))
    )
    assert part == pytest.approx(whole, rel=0.05) and part != whole


def test_it_is_said_of_each_experiment() -> None:
    told = no_free_run_follows({"run 2", "run 1"}, DiagnosisSettings())
    assert [sentence[:6] for sentence in told] == ["run 1:", "run 2:"]
    assert "1e-05 of a state's travel" in told[0] and "10 % of its error" in told[0]
