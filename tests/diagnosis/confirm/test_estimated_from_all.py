"""What the model as it stands explains once it is estimated from all experiments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.estimated_from_all import estimated_from_all, explained_without
from greybox_torch.diagnosis.confirm.free_runs import FreeRuns
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.hypothesis.final import Final


@pytest.fixture(scope="module")
def complete(motor, begun, motor_data):
    """A study of a motor that lacks nothing, and its free runs."""
    data = motor_data(noise=0.01)
    study = begun(data, motor).study
    return study, FreeRuns(study, data)


def bent(runs: FreeRuns, factor: float) -> Judgement:
    """The model as it stands with the values that all experiments lead to, but with another inertia."""
    problem = estimated_from_all(Judgement.of(runs, Final(runs.problem, None))).plain.problem
    values = problem.values * np.where(np.array(problem.names) == "J", factor, 1.0)
    return Judgement.of(runs, Final(problem.with_values(values), None))


def test_it_follows_all_of_them_whatever_the_estimate_was_bent_to(complete) -> None:
    _, runs = complete
    far, near = bent(runs, 3.0), bent(runs, 1.0)
    assert far.left(False)[1] > 10.0 and near.left(False)[1] < 1.2
    by_all = estimated_from_all(far)
    assert by_all.left(False)[1] < 1.2
    assert by_all.plain.problem.values == pytest.approx(near.plain.problem.values, rel=1e-3)


def test_what_it_explains_so_is_no_effects_doing(complete) -> None:
    study, runs = complete
    far, near = bent(runs, 3.0), bent(runs, 1.1)
    explained = replace(far, augmented=near.plain, with_effects=near.refit)
    assert explained.mismatch(True) < 0.25 * explained.mismatch(False), "a finding over longer windows"
    told = explained_without(study, explained)
    assert told.startswith("Estimated from all experiments, the model as it stands leaves less in free runs (")
    assert told.endswith("Estimate it from more of them.")


def test_an_effect_that_leaves_less_is_not_explained_so(complete, monkeypatch) -> None:
    """Noise alone is left with it, and something beyond without."""
    study, runs = complete
    far, best = bent(runs, 3.0), bent(runs, 1.0)
    monkeypatch.setattr("greybox_torch.diagnosis.confirm.estimated_from_all.estimated_from_all", lambda judged: far)
    assert explained_without(study, replace(far, augmented=best.plain, with_effects=best.refit)) == ""
