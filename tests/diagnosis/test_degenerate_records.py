"""Records that show little or nothing: standstill, constant and noise-free channels. Each kind once failed or was told wrongly."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greybox_torch.data import DataSet, Recording
from greybox_torch.diagnosis.confirm.judgement import _share_left
from greybox_torch.diagnosis.contradictions import contradictions
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.files import json_text
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems.load import load_model

LENGTH = 120


@pytest.fixture(scope="module")
def rotor(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'small.py'}:Rotor")


@pytest.fixture(scope="module")
def slide(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'small.py'}:Slide")


def said(model: GreyBoxModel, **signals: np.ndarray) -> dict[str, Any]:
    """What a diagnosis of two equal records says, its search stopped at once; numpy has nothing to warn of."""
    roles = ("estimation", "validation")
    data = DataSet([Recording.from_arrays(role, signals, sample_time=0.01, role=role) for role in roles])
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        verdict = diagnose(data, model, time_limit=0.0).verdict.as_json()
    result = json.loads(json_text(verdict))
    assert contradictions(result) == []
    return result


def test_exact_standstill(rotor: GreyBoxModel) -> None:
    """Seen: an error of "inf times the noise" where every sample is zero."""
    result = said(rotor, voltage=np.zeros(LENGTH), speed=np.zeros(LENGTH))
    assert not result["mismatch"] and result["left"]["times_noise"] is None
    assert "how much of its error is noise is not known" in result["left"]["sentence"]


def test_dead_sensor_of_a_machine_that_is_driven(rotor: GreyBoxModel) -> None:
    result = said(rotor, voltage=np.tile([1.0, -1.0], LENGTH // 2), speed=np.zeros(LENGTH))
    assert all(row["refit"]["fit"] is None and row["refit"]["rmse"] < 0.1 for row in result["fit"])


def test_a_position_missing_around_the_start_of_a_window(slide: GreyBoxModel) -> None:
    """Seen: slopes divided by 1e-300 where no sample around is known."""
    rng = np.random.default_rng(0)
    position = 0.1 * np.sin(0.2 * np.arange(LENGTH)) + rng.normal(0, 1e-3, LENGTH)
    position[30:70] = np.nan
    assert said(slide, force=2.0 * np.cos(0.2 * np.arange(LENGTH)), position=position)["fit"]


@pytest.mark.parametrize(
    ("before", "after", "left"),
    [(2.0, 0.5, 0.25), (0.0, 0.0, 0.0), (0.0, 1e-9, 0.0), (np.inf, np.inf, 1.0), (np.inf, 3.0, 0.0)],
)
def test_share_of_a_mismatch_that_is_left(before: float, after: float, left: float) -> None:
    assert _share_left(before, after) == left
