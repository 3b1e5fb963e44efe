"""How large the mismatch of a model is beside the motion itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known, mean_squared_step, noise_floor
from greybox_torch.diagnosis.hypothesis.window_errors import window_errors
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.free_run import simulate
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit


def mismatch_share(fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """Root mean square error beyond the noise, in units of the outputs' spread: the largest over the window lengths."""
    return largest_share(fitted.fits, settings)


def largest_share(fits: Sequence[WindowFit], settings: DiagnosisSettings) -> float:
    """The same of fits over windows of several lengths; zero where there are none."""
    return max((_share(fit.mean_square, fit.problem, settings) for fit in fits), default=0.0)


def least_mismatch(study: Study) -> float:
    """The mismatch, in the same unit, below which nothing is looked for: simulations of one machine differ by as much, or sensors are so
    good that they show a shift in time by a small part of the sampling interval.

    When within its interval a sample was taken, and when the input began to act, nobody knows better than that. Where the noise is larger
    than the error of such a shift, what an effect leaves beyond it over windows may be less, and is told by its many samples.
    """
    settings, problem = study.settings, study.problem
    recorded = problem if study.recorded is None else replace(problem, records=study.recorded)
    spread = _mean_squared_spread(recorded)
    shift = settings.least_shift * float(np.sqrt(mean_squared_step(recorded, settings) / spread))
    shown = float(np.sqrt(noise_floor(recorded, settings) / spread)) < shift
    return max(settings.least_mismatch, min(shift, settings.most_of_shift)) if shown else settings.least_mismatch


def negligible(study: Study, fitted: Hypothesis) -> bool:
    """Whether a mismatch is below that: over windows and, as what drifts shows there alone, over whole records.

    What is more than noise, and more than simulations differ by, has to be a shift in time. Less than that may be what a few windows show
    of what drifts far. Seen: a drive whose torque saturates in two of sixteen windows, told as complete (0.95) with 5 times the noise left
    over windows and 500 in free runs.
    """
    settings = study.settings
    share, least = mismatch_share(fitted, settings), least_mismatch(study)
    if share >= max(least, settings.least_mismatch):
        return False
    noise_alone = times_noise(study.problem, fitted, settings) <= settings.above_noise
    if share < settings.least_mismatch and noise_alone:
        return True
    if share >= settings.least_mismatch and not noise_alone and not _is_shift(study, fitted):
        return False
    return _share_of_whole_records(fitted, settings, study.budget) < least


def _is_shift(study: Study, fitted: Hypothesis) -> bool:
    """Whether a shift in time of every output takes away most of what a fit leaves beyond the noise, over the windows that show it best.

    Seen: a screw drive whose nut has 12 µm of play on a stroke of 55 mm, 34 times the noise of its scale, was told as complete.
    """
    worst = max(fitted.fits, key=lambda fit: fit.mean_square)
    errors = window_errors(worst, fitted.simulator)
    rates = np.full_like(errors, np.nan)
    simulated = worst.problem.window_records.y - errors
    for first, last in zip(worst.windows.start, worst.windows.last, strict=True):
        if last - first > 1:
            rates[:, first : last + 1] = np.gradient(simulated[:, first : last + 1], axis=1)
    weights = worst.problem.weights[:, None]
    errors, rates = weights * np.where(np.isnan(rates), np.nan, errors), weights * rates
    shifts = np.nansum(errors * rates, axis=1) / np.maximum(np.nansum(rates**2, axis=1), 1e-300)
    left = np.nanmean((errors - shifts[:, None] * rates) ** 2)
    noise = noise_floor(study.problem, study.settings)
    return bool(left - noise < study.settings.left_by_shift * (np.nanmean(errors**2) - noise))


@lru_cache(maxsize=1)
def _share_of_whole_records(fitted: Hypothesis, settings: DiagnosisSettings, budget: SearchBudget) -> float:
    """:func:`mismatch_share` of a fit to whole records."""
    problem = finish(fitted, settings, budget).problem
    runs = simulate(problem, fitted.simulator)
    measured = (problem.records.y[:, problem.records.span(e)].T for e in range(len(runs)))
    errors = np.concatenate([y - run for y, run in zip(measured, runs, strict=True)]) * problem.weights
    return _share(float(np.nanmean(errors**2)), problem, settings) if np.isfinite(errors).any() else np.inf


def _share(mean_square: float, problem: Problem, settings: DiagnosisSettings) -> float:
    """The root of a mean squared error beyond the noise, in units of the outputs' spread."""
    known = floor_known(problem, settings)  # else what looks like noise may be motion, and hide what is missing
    beyond = max(mean_square - known * noise_floor(problem, settings), 0.0)
    return float(np.sqrt(beyond / _mean_squared_spread(problem)))


def _mean_squared_spread(problem: Problem) -> float:
    spread = np.nanstd(problem.records.y, axis=1) * problem.weights
    return max(float(np.mean(spread**2)), 1e-300)
