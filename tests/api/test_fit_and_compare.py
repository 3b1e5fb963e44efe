"""A fitted model is simulated by `fit` as by `compare`, where both estimate the start states on the first tenth."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api import fit, fit_many
from tests.api.motor import UNITS, Motor


@pytest.fixture
def quick() -> gt.DataSet:
    """A motor with a lag of about one sample: at rest where it is estimated, driven in steps where it is judged."""
    constant, steps = np.full(200, 5.0), np.where(np.arange(200) % 20 < 10, 5.0, -5.0)
    recordings = [
        gt.Recording.from_arrays("Rest", {"voltage": constant, "speed": constant * 2}, sample_time=0.01, units=UNITS),
        gt.Recording.from_arrays(
            "Steps", {"voltage": steps, "speed": steps * 1.7}, sample_time=0.01, role="validation", units=UNITS
        ),
    ]
    return gt.DataSet(recordings, parameters={"J": {"value": 0.0004, "fixed": True}, "b": {"value": 0.05}})


@pytest.mark.parametrize("together", [False, True])
def test_validation_takes_as_many_steps_a_sample_as_in_compare(
    monkeypatch: pytest.MonkeyPatch, quick: gt.DataSet, together: bool
) -> None:
    """Seen: 55.3 % by `fit`, 36.5 % by `compare`: the estimate took 16 steps a sample, all experiments together needed 32."""
    for module in (
        fit,
        fit_many,
    ):  # a motor at rest needs one step a sample, and is refused as one from which nothing can be estimated
        monkeypatch.setattr(module, "check_moving", lambda data, recordings: None)
    found = gt.fit_many(Motor(), [quick])[0] if together else gt.fit(Motor(), quick)
    assert isinstance(found, gt.FitResult) and found.estimation.substeps == 1
    compared = gt.compare(quick, {"fit": found})
    assert compared.runs["fit"].substeps > 1
    (own,) = [row for row in found.scores if row["model"] == "refit" and row["role"] == "validation"]
    (other,) = [row for row in compared.scores if row["role"] == "validation"]
    assert own["fit"] == pytest.approx(other["fit"], abs=1e-6)
