"""An error that nothing explains: missing physics, or a disturbance that nobody measured."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.describe import without_a_name
from greybox_torch.diagnosis.describe.residual_tests import Detection, Largest, Remains
from greybox_torch.diagnosis.describe.without_a_name import error_without_a_name, is_missing
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()


def detection(past: float) -> Detection:
    """Errors whose correlation with past inputs is ``past``, where 0.1 is chance."""
    remains = Remains(Largest(0.9, 0.05), Largest(past, 0.1))
    return Detection("run", "speed", remains, remains, Largest(0.0, 0.1), 10.0)


@pytest.mark.parametrize(
    ("error", "chosen_by", "past", "complete", "missing"),
    [
        (None, 1.0, 0.5, True, False),
        (5.3, 2.9, 0.02, True, False),
        (5.3, 2.9, 0.8, True, True),
        (5.3, 2.9, 0.3, True, False),
        (5.3, 2.9, 0.02, False, True),
        (5.3, 1.0, 0.02, True, True),
        (36.0, 30.0, 0.02, True, True),
    ],
    ids=[
        "at the noise",
        "a disturbance",
        "follows inputs",
        "laws a little richer",
        "stopped",
        "shown by others alone",
        "large",
    ],
)
def test_what_no_law_explains_is_missing_where_it_repeats_or_is_large(
    error, chosen_by, past, complete, missing
) -> None:
    assert is_missing(error, chosen_by, [detection(past)], complete, SETTINGS) is missing


def test_a_random_load_on_a_complete_model_is_no_missing_physics(motor_data, motor, monkeypatch) -> None:
    """Seen: a pump whose impeller was loaded at random, 5 times the noise: "something is missing"."""

    def nothing_found(study, state, before=None):
        yield state
        return state

    rng, load = np.random.default_rng(8), [0.0]

    def torque(position: float, speed: float) -> float:
        load[0] += -0.002 * load[0] + 0.0004 * rng.normal()
        return load[0]

    monkeypatch.setattr("greybox_torch.diagnosis.selection.search", nothing_found)
    verdict = diagnose(motor_data(torque=torque, noise=0.01), motor).verdict
    assert not verdict.mismatch and verdict.effects == ()
    assert verdict.confidence < 0.8 and verdict.left is not None and verdict.left.times_noise > 3.0
    assert any("disturbance that nobody measured" in line for line in verdict.evidence)
    assert f"on the worst experiment its error is {verdict.disturbed:.3g} times the noise" in verdict.sentence


@pytest.mark.parametrize("shown", [True, False])
def test_what_one_validation_experiment_shows_over_windows_is_missing(
    dead_zone_search, stub, monkeypatch, shown
) -> None:
    """Seen: an end stop that one validation experiment reached, a fit of 6 % there: "nothing is missing" (0.95).

    Where the recordings tell no more than an upper bound of the noise, a mismatch that anybody sees counts, wherever it shows.
    """
    search = dead_zone_search
    small = tuple(replace(f, mean_square=1e-8) for f in search.plain.fits)
    state: Any = stub(plain=replace(search.plain, fits=small))
    large = search.plain.fits if shown else small
    times = np.array([1.0, 500.0 if shown else 1.0])
    others: Any = stub(
        fits=lambda hypothesis: large, times_noise=lambda hypothesis: times, problem=search.study.problem
    )
    judged: Any = stub(mismatch_share=0.9, times_noise=times)
    monkeypatch.setattr(without_a_name, "floor_known", lambda problem, settings: False)
    monkeypatch.setattr(without_a_name, "hardly_followed", lambda judged: False)
    error = error_without_a_name(search.study, state, others, judged)
    assert error == (500.0 if shown else None)
    assert is_missing(error, 1.0, [], True, SETTINGS) is shown


@pytest.mark.parametrize(
    ("times", "fit", "missing"), [(150.0, 26.0, True), (150.0, 72.0, False), (5.0, 26.0, False)], ids=str
)
def test_what_free_runs_hardly_follow_lacks_something(dead_zone_search, stub, monkeypatch, times, fit, missing) -> None:
    """Seen: a crane's trolley without its friction, 150 times the noise and a fit of 26 %, 1.9 times over windows: "nothing is missing".
    A complete arm that drifts is at 72 %."""
    search = dead_zone_search
    by_windows = np.array([1.9])
    others: Any = stub(
        fits=lambda hypothesis: (), times_noise=lambda hypothesis: by_windows, problem=search.study.problem
    )
    monkeypatch.setattr(without_a_name, "largest_share", lambda fits, settings: 0.01)
    monkeypatch.setattr(without_a_name, "mismatch_share", lambda plain, settings: 0.01)
    monkeypatch.setattr(without_a_name, "times_noise", lambda problem, plain, settings: 1.8)
    monkeypatch.setattr(without_a_name, "floor_known", lambda problem, settings: False)
    scores = (stub(experiment="run 2", fit=fit),)
    judged: Any = stub(
        mismatch_share=0.13,
        times_noise=np.array([times]),
        settings=SETTINGS,
        refit=None,
        judging=lambda c: stub(scores=scores),
    )
    error = error_without_a_name(search.study, stub(plain=search.plain), others, judged)
    lost = without_a_name.hardly_followed(judged)
    assert lost is missing and is_missing(error, 1.8, [], True, SETTINGS, lost) is missing
    assert error == (1.9 if missing else None)
