"""Free runs of whole experiments."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import free_runs
from greybox_torch.diagnosis.confirm.free_runs import FreeRuns
from greybox_torch.estimate.comparison import compare
from greybox_torch.simulation.simulator import Simulator


@pytest.fixture(scope="module")
def runs(motor, begun, motor_data) -> FreeRuns:
    data = motor_data(noise=0.01)
    return FreeRuns(begun(data, motor).study, data)


def with_values(runs: FreeRuns, **changed: float):
    """The problem of all experiments with some parameters set, and its simulator."""
    values = {**runs.problem.values_by_name, **changed}
    problem = runs.problem.with_values(np.array([values[n] for n in runs.problem.names]))
    return problem, Simulator.of(problem.model, (), runs.options)


def test_a_model_far_stiffer_than_the_card_is_simulated_with_finer_steps(runs) -> None:
    """Seen: the refit of a heating coil, "-inf %" in one experiment, as steps of a sample no longer followed it."""
    own = runs.problem.values_by_name
    problem, simulator = with_values(runs, J=own["J"] / 500.0)
    coarse = compare(problem, runs.recordings, simulator, estimate_starts=False)
    assert not all(np.isfinite(y).all() for y in coarse.simulated), "or the test shows nothing"
    found = runs._simulated(problem, simulator)
    fine = compare(problem, runs.recordings, simulator.with_substeps(128), estimate_starts=False)
    for y, exact in zip(found.simulated, fine.simulated, strict=True):
        np.testing.assert_allclose(y, exact, atol=0.02 * np.ptp(exact))


def test_a_model_that_runs_away_is_lost_however_fine_the_steps(runs) -> None:
    problem, simulator = with_values(runs, b=-1e3)
    assert not all(np.isfinite(y).all() for y in runs._simulated(problem, simulator).simulated)


def test_where_steps_of_a_sample_do_nothing_is_simulated_twice(runs, monkeypatch) -> None:
    problem, simulator = with_values(runs)
    asked = []
    monkeypatch.setattr(free_runs, "compare", lambda *args, **how: asked.append(args) or compare(*args, **how))
    found = runs._simulated(problem, simulator)
    assert len(asked) == 1
    whole = compare(problem, runs.recordings, simulator, estimate_starts=False)
    assert all(np.array_equal(a, b) for a, b in zip(found.simulated, whole.simulated, strict=True))
