"""How large the mismatch is beside the motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.beside_noise import why_negligible
from greybox_torch.diagnosis.hypothesis import mismatch as module
from greybox_torch.diagnosis.hypothesis.mismatch import least_mismatch, mismatch_share, negligible
from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.select.posterior import confidence
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of


def test_the_error_beyond_the_noise_in_units_of_the_spread(motor, begun, motor_data) -> None:
    plain = begun(motor_data(noise=0.1), motor).plain
    spread = float(np.std(plain.problem.records.y))
    larger = replace(plain, fits=tuple(replace(fit, mean_square=0.01 + (0.3 * spread) ** 2) for fit in plain.fits))
    assert mismatch_share(larger, DiagnosisSettings()) == pytest.approx(0.3, rel=0.02)
    silent = replace(plain, fits=tuple(replace(fit, mean_square=1e-3) for fit in plain.fits))
    assert mismatch_share(silent, DiagnosisSettings()) == 0.0


def test_nothing_is_looked_for_where_simulations_differ_by_as_much(dead_zone_search) -> None:
    found = dead_zone_search
    share = mismatch_share(found.plain, found.study.settings)
    assert share > found.study.settings.least_mismatch
    coarse = replace(found.study, settings=replace(found.study.settings, least_mismatch=min(1.0, 1.1 * share)))
    assert result_of(search(coarse, found.state)).steps == ()


def test_nor_where_sensors_show_a_shift_by_a_part_of_the_sampling_interval(dead_zone_search) -> None:
    found = dead_zone_search
    study, records = found.study, found.study.problem.records
    steps = np.concatenate([np.diff(records.y[0, records.span(e)]) for e in range(len(records.first))])
    noise = 0.02
    step = float(np.sqrt(np.mean(steps**2) - 2 * noise**2) / np.std(records.y))
    assert 0.05 * step < noise / np.std(records.y), "the noise hides such a shift"
    assert least_mismatch(study) == study.settings.least_mismatch
    shifted = replace(study, settings=replace(study.settings, least_shift=1.0, most_of_shift=1.0))
    assert least_mismatch(shifted) == pytest.approx(step, rel=0.05)
    assert least_mismatch(replace(study, settings=replace(study.settings, least_shift=1.0))) == 1e-3
    turn = np.sin(2 * np.pi * np.arange(records.y.shape[1]) / 1000)[None]
    recorded = replace(study, recorded=replace(records, y=turn))
    assert least_mismatch(recorded) == pytest.approx(0.05 * 2 * np.pi / 1000, rel=0.01), "of what was recorded"


def test_what_is_negligible_is_said_and_sure(dead_zone_search) -> None:
    found = dead_zone_search
    settings = replace(found.study.settings, least_shift=1.0, most_of_shift=1.0, least_mismatch=1.0)
    study = replace(found.study, settings=settings)
    assert negligible(study, found.plain) and not negligible(found.study, found.plain)
    (sentence,) = why_negligible(study, found.state.plain)
    assert sentence.endswith("nothing was looked for.")
    assert not why_negligible(found.study, found.state.plain)
    assert confidence(study, found.state, (), True, None, 30.0) == settings.confidence_nothing


def test_what_drifts_over_whole_records_is_not_negligible(dead_zone_search, monkeypatch) -> None:
    """As dry friction of a drive whose angles alone are measured: over windows start states take it up."""
    found = dead_zone_search
    shifted = replace(found.study, settings=replace(found.study.settings, least_shift=1.0))
    problem = found.plain.problem
    beyond = 0.5 * least_mismatch(shifted) * float(np.std(problem.records.y))
    error = noise_floor(problem, shifted.settings) + beyond**2
    plain = replace(found.plain, fits=tuple(replace(fit, mean_square=error) for fit in found.plain.fits))
    assert not negligible(found.study, plain)
    for left, nothing in ((0.0, True), (1.0, False)):
        module._share_of_whole_records.cache_clear()
        monkeypatch.setattr(module, "simulate", lambda problem, simulator, of=1.0 - left: [of * problem.records.y.T])
        assert negligible(shifted, plain) == nothing
    module._share_of_whole_records.cache_clear()


@pytest.mark.parametrize(("error", "nothing"), [("late", True), ("rough", False)])
def test_more_than_noise_has_to_be_a_shift_in_time(dead_zone_search, monkeypatch, error: str, nothing: bool) -> None:
    """Seen: a screw drive whose nut has 12 µm of play on a stroke of 55 mm, told as complete at 34 times the noise of its scale."""
    found = dead_zone_search
    shifted = replace(found.study, settings=replace(found.study.settings, least_shift=1.0, most_of_shift=0.05))
    noise, least = noise_floor(found.problem, shifted.settings), least_mismatch(shifted)
    beyond = (0.9 * least * np.std(found.problem.records.y)) ** 2
    assert beyond > 4 * noise, "the case is above the noise"
    plain = replace(found.plain, fits=tuple(replace(fit, mean_square=noise + beyond) for fit in found.plain.fits))
    measured = plain.fits[0].problem.window_records.y

    def left(fit: object, simulator: object) -> np.ndarray:
        rate = np.gradient(measured, axis=1)
        shape = rate if error == "late" else np.random.default_rng(0).normal(size=measured.shape)
        return np.sqrt(beyond / np.mean(shape**2)) * shape

    monkeypatch.setattr(module, "window_errors", left)
    monkeypatch.setattr(module, "_share_of_whole_records", lambda *given: 0.0)
    assert negligible(shifted, plain) == nothing


@pytest.mark.parametrize(
    ("times", "whole", "nothing"), [(1.0, 1e-2, True), (5.0, 1e-6, True), (5.0, 1e-2, False)], ids=str
)
def test_more_than_noise_is_looked_into_where_free_runs_drift_however_little_windows_show(
    dead_zone_search, monkeypatch, times: float, whole: float, nothing: bool
) -> None:
    """Seen: a drive whose torque saturates now and then, told as complete (0.95) at 5 times the noise, 500 in free runs."""
    found = dead_zone_search
    settings = replace(found.study.settings, least_mismatch=0.5)
    study = replace(found.study, settings=settings)
    monkeypatch.setattr(module, "mismatch_share", lambda *given: 0.1)
    monkeypatch.setattr(module, "least_mismatch", lambda study: 1e-3)
    monkeypatch.setattr(module, "times_noise", lambda *given: times)
    monkeypatch.setattr(module, "_share_of_whole_records", lambda *given: whole)
    assert negligible(study, found.plain) == nothing


@pytest.mark.parametrize(("free", "sure"), [(1.2, True), (float("nan"), True), (150.0, False)])
def test_nothing_is_less_sure_where_free_runs_leave_many_times_the_noise(motor_data, motor, begun, free, sure) -> None:
    """Seen: a drive's limit within the first samples of one experiment: windows left noise alone, and nothing was missing (0.95)."""
    complete = begun(motor_data(), motor)
    settings = complete.study.settings
    said = confidence(complete.study, complete.state, (), True, None, free)
    assert said == (settings.confidence_nothing if sure else settings.confidence_nothing_above_noise)
