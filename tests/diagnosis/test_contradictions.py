"""No verdict contradicts itself: by the rules, and by how a verdict is made."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis import pipeline
from greybox_torch.diagnosis.contradictions import contradictions, worse_than_refit
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.errors import NumericalError
from greybox_torch.files import json_text


def row(before: float | None, after: float | None, output: str = "speed", fit: float = 50.0) -> dict[str, Any]:
    return {
        "experiment": "run",
        "role": "validation",
        "output": output,
        "start": {"fit": fit, "rmse": 0.5},  # the spread is 1 where fit is 50 %
        "refit": {"fit": None, "rmse": before},
        "augmented": {"fit": None, "rmse": after},
    }


@pytest.mark.parametrize(
    ("rows", "worse"),
    [
        ([row(0.5, 0.4)], False),
        ([row(0.5, 0.51)], True),
        ([row(1e-9, 9e-9)], False),  # both of them rounding
        ([row(0.0, 1e-12)], False),
        ([row(0.0, 1e-3)], True),
        ([row(None, None)], False),
        ([row(None, 0.1)], False),
        ([row(0.1, None)], True),
        ([row(None, 0.1), row(0.1, None)], True),
        ([row(None, None), row(0.1, 0.2)], True),
        ([row(np.inf, np.inf), row(0.1, 0.2)], True),
        ([row(100.0, 50.0), row(0.1, 0.2)], True),  # the small error doubled, in its own units
        ([row(100.0, 30.0), row(0.1, 0.2)], True),
        ([row(100.0, 1.0), row(0.1, 0.2)], False),  # a hundredth, beside one of small motion
        ([row(100.0, 1.0), row(0.1, 10.0)], True),
        ([row(100.0, 1.0), row(0.0, 1e-3)], True),
        ([row(0.0, 0.0, "constant", -np.inf)], False),
        ([], False),
    ],
)
def test_worse_than_the_refit(rows: list[dict[str, Any]], worse: bool) -> None:
    assert worse_than_refit(rows) is worse


def test_estimation_experiments_do_not_count() -> None:
    assert not worse_than_refit([row(0.1, 0.2) | {"role": "estimation"}])


def test_experiments_that_no_free_run_follows_do_not_count() -> None:
    rows = [row(0.1, 0.2), row(0.1, 0.05) | {"experiment": "other"}]
    assert worse_than_refit(rows) and not worse_than_refit(rows, {"run"})
    verdict = {"effects": [], "mismatch": True, "fit": rows, "unstable": ["run"]}
    named = [{"port": "rotor", "mechanism": "coulomb_friction", "probability": 0.9, "parameters": {}}]
    assert contradictions(verdict | {"effects": named}) == []
    assert len(contradictions(verdict | {"effects": named, "unstable": ["other"]})) == 1
    (told,) = contradictions(verdict | {"effects": named, "unstable": ["run", "other"]})
    assert told == "more than half of the validation experiments do not count"


def dead_zone(voltage: np.ndarray) -> np.ndarray:
    return np.sign(voltage) * np.maximum(np.abs(voltage) - 0.5, 0.0)


def test_what_would_contradict_itself_is_taken_back(motor_data, motor, monkeypatch) -> None:
    """However it came about: here by a probability that is none."""
    told = pipeline.describe

    def beyond(*args: Any) -> tuple[Effect, ...]:
        return tuple(replace(e, probability=1.2) for e in told(*args))

    monkeypatch.setattr(pipeline, "describe", beyond)
    found = diagnose(motor_data(acting=dead_zone), motor)
    said = json.loads(json_text(found.verdict.as_json()))
    assert said["effects"] == [] and said["mismatch"] is True and contradictions(said) == []
    assert any("its probability is 1.2" in line for line in said["evidence"])
    assert found.attachments == [] and found.model is motor
    assert [r["augmented"] for r in said["fit"]] == [r["refit"] for r in said["fit"]]


def test_a_verdict_without_findings_that_contradicts_itself_does_not_leave(motor_data, motor, monkeypatch) -> None:
    monkeypatch.setattr(pipeline, "confidence", lambda *args: 1.5)
    with pytest.raises(NumericalError, match=r"its confidence is 1\.5"):
        diagnose(motor_data(400), motor)


def test_an_effect_without_a_size_is_no_finding(motor_data, motor, monkeypatch) -> None:
    monkeypatch.setattr(pipeline, "sizes", lambda study, state, gains: dict.fromkeys(state.prefixes, float("nan")))
    verdict = diagnose(motor_data(acting=dead_zone), motor).verdict
    assert verdict.effects == () and len(verdict.refinements) == 1
    assert contradictions(verdict.as_json()) == []
