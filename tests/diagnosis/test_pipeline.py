"""The whole diagnosis, on recordings of the documentation's motor that were simulated without the package."""

from __future__ import annotations

import time

import numpy as np
import pytest

from greybox_torch.diagnosis.pipeline import Diagnosis, diagnose
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.errors import UserError
from greybox_torch.mechanisms.stored import restored_model


def dead_zone(voltage: np.ndarray) -> np.ndarray:
    return np.sign(voltage) * np.maximum(np.abs(voltage) - 0.5, 0.0)


@pytest.fixture(scope="module")
def found(motor_data, motor) -> Diagnosis:
    return diagnose(motor_data(acting=dead_zone), motor, seed=7)


def test_dead_zone_is_found_named_and_measured(found) -> None:
    (effect,) = found.verdict.effects
    assert (effect.port, effect.mechanism) == ("actuator", "actuator_deadzone")
    assert effect.probability > 0.8 and found.verdict.confidence > 0.8
    half_width = effect.parameters["half_width"]
    assert half_width["value"] == pytest.approx(0.5, abs=4 * half_width["std"]) and half_width["std"] < 0.01
    assert half_width["unit"] == "V"
    assert effect.explained > 0.95
    assert effect.signals == ("voltage",)
    assert effect.curve is not None and effect.curve.seen is not None and effect.profiles
    (along,) = effect.timelines
    assert along.experiment == "run 2" and along.share.sum() == pytest.approx(1.0)
    assert effect.ceiling is not None and 0.5 < effect.ceiling <= 1.0


def test_fit_before_and_after(found) -> None:
    start, refit, augmented = (found.verdict.scores[m][1] for m in ("start", "refit", "augmented"))
    assert start.role == "validation"
    assert start.fit < refit.fit < 90 < 98 < augmented.fit
    assert augmented.rmse == pytest.approx(0.02, rel=0.1)  # the noise
    assert found.values["J"] == pytest.approx(0.02, rel=0.02) and found.values["b"] == pytest.approx(0.05, rel=0.02)


def test_verdict_says_how_it_came_about(found) -> None:
    verdict = found.verdict
    assert verdict.complete and verdict.seed == 7 and verdict.mismatch
    assert verdict.evidence and any("Held out: input dead zone at actuator" in line for line in verdict.evidence)
    assert any("errors, model as it stands, are not correlated with past inputs" in line for line in verdict.evidence)
    assert any(line.startswith("They are not white") for line in verdict.evidence)
    assert not any("feedback" in line for line in verdict.evidence)
    assert sum(verdict.stages.values()) == pytest.approx(verdict.seconds, rel=0.1)
    assert [(row[0], row[1]) for row in verdict.ranking[:3]].count(("actuator", "actuator_deadzone")) == 1
    trace = verdict.traces[1]
    assert (trace.experiment, trace.output, trace.unit) == ("run 2", "speed", "rad/s")
    error = trace.measured - trace.augmented
    assert np.sqrt(np.mean(error**2)) == pytest.approx(verdict.scores["augmented"][1].rmse)


def test_model_that_is_recommended_can_be_restored(found, motor) -> None:
    again = restored_model(motor, found.attachments)
    assert again.declared_parameters == found.model.declared_parameters
    assert set(found.values) == {p.name for p in again.declared_parameters}
    assert set(found.initial["run 1"]) == {"speed"}


@pytest.fixture(scope="module")
def nothing(motor_data, motor) -> Diagnosis:
    return diagnose(motor_data(), motor)


def test_nothing_is_missing(nothing, motor) -> None:
    verdict = nothing.verdict
    assert verdict.complete and not verdict.mismatch and verdict.effects == ()
    assert verdict.confidence >= 0.8
    assert verdict.scores["augmented"] == verdict.scores["refit"]
    assert nothing.attachments == [] and nothing.model is motor
    assert any(line.startswith("They are white") for line in verdict.evidence)
    assert nothing.values["J"] == pytest.approx(0.02, rel=0.02)


def test_no_estimation_experiment(motor_data, motor) -> None:
    with pytest.raises(UserError, match="no experiment has the role 'estimation'; expected at least one"):
        diagnose(motor_data(200, ("validation", "validation")), motor)


def nothing_found(study, state, before=None):
    """A search that takes no step."""
    yield state
    return state


@pytest.mark.parametrize("floor_is_known", [True, False])
def test_what_nothing_explains_is_said_to_be_missing(motor_data, motor, monkeypatch, floor_is_known) -> None:
    """Seen: an error of twelve times the noise, and "nothing is missing"; 330 times its upper bound, where impacts are in the record."""
    monkeypatch.setattr("greybox_torch.diagnosis.selection.search", nothing_found)
    monkeypatch.setattr(
        "greybox_torch.diagnosis.describe.without_a_name.floor_known", lambda problem, settings: floor_is_known
    )
    verdict = diagnose(motor_data(acting=dead_zone, noise=0.002), motor).verdict
    assert verdict.complete and verdict.mismatch and verdict.effects == () and verdict.unexplained > 3.0
    assert verdict.confidence == DiagnosisSettings().confidence_missing_unnamed
    assert (
        verdict.sentence.startswith("Something is missing") and "no curve of one signal explains it" in verdict.sentence
    )
    assert verdict.as_json()["mismatch"] is True


def test_what_an_effect_explains_and_what_is_left_are_all(motor_data, motor) -> None:
    """Seen: 100 % of the error explained, and beside it 36 % of it left: a floor in other units was taken off."""

    def acting(u):
        return dead_zone(u) + 0.05 * np.maximum(u, 0.0)  # a small effect beside it stays

    found = diagnose(motor_data(acting=acting, noise=0.002), motor).verdict.as_json()
    (effect,) = found["effects"]
    assert 0.5 < effect["explained"] < 0.999
    assert effect["explained"] == pytest.approx(1.0 - found["left"]["share"], abs=1e-3)


def stopped_at(word: str, error: type[BaseException]):
    def progress(text: str) -> None:
        if text.startswith(word):
            raise error

    return progress


def test_interruption_leaves_a_verdict(motor_data, motor) -> None:
    progress = stopped_at("screening", KeyboardInterrupt)
    verdict = diagnose(motor_data(acting=dead_zone), motor, progress=progress).verdict
    assert not verdict.complete and verdict.effects == ()
    assert verdict.confidence == 0.5
    assert "stopped before it could say what" in verdict.sentence and verdict.unexplained > 3.0
    assert verdict.scores["refit"][1].fit > verdict.scores["start"][1].fit


def test_time_limit_stops_the_search_and_leaves_a_verdict(motor_data, motor, monkeypatch, stub) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    late, real = [0.0], time.perf_counter
    monkeypatch.setattr("greybox_torch.deadline.time", stub(perf_counter=lambda: real() + late[0]))
    said = []

    def progress(text: str) -> None:
        said.append(text)
        late[0] = 1000.0 * text.startswith("refitting actuator")

    verdict = diagnose(motor_data(acting=dead_zone), motor, time_limit=500.0, progress=progress).verdict
    assert not verdict.complete
    assert len([text for text in said if text.startswith("refitting actuator")]) == 1
    assert len(verdict.scores["augmented"]) == 2
    assert any("stopped before" in line for line in verdict.evidence)


def test_no_time_at_all_leaves_a_verdict(motor_data, motor) -> None:
    assert not diagnose(motor_data(), motor, time_limit=0.0).verdict.complete
