"""How large the noise of a recording is, from the recording alone."""

from __future__ import annotations

import warnings

import numpy as np

from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit


def reaches_noise(problem: Problem, fit: WindowFit, settings: DiagnosisSettings, times: float | None = None) -> bool:
    """Whether a fit leaves white noise alone, where the recordings tell how much of it there is.

    Args:
        times: how many times the noise the root mean square error may be; by default ``noise_reached``.
    """
    most = settings.noise_reached if times is None else times
    return floor_known(problem, settings) and fit.mean_square < most**2 * noise_floor(problem, settings)


def at_floor(problem: Problem, fit: WindowFit, settings: DiagnosisSettings) -> bool:
    """Whether a fit leaves no more than the noise, as nearly as that is known: from no other start could it have come farther."""
    return reaches_noise(problem, fit, settings, float(np.sqrt(1.0 + settings.no_mismatch)))


def floor_known(problem: Problem, settings: DiagnosisSettings) -> bool:
    """Whether the recordings tell how much noise there is: differences of several orders agree on it.

    What is left of the motion in them would not be the same in each.
    """
    first = settings.noise_differences
    floors = [_floor(problem, order) for order in (first, first + 1, first + 2)]
    return max(floors) < settings.noise_floors_agree * min(floors)


def noise_floor(problem: Problem, settings: DiagnosisSettings) -> float:
    """Mean squared weighted error that white sensor noise alone would leave, as the outputs' high-frequency floor has it.

    The variance of the third differences of white noise is 20 times its own. Where the sampling is so slow that the motion itself is
    rough, this is an upper bound.

    Source: J. von Neumann et al., "The mean square successive difference", Annals of Mathematical Statistics 12, 1941.
    """
    return _floor(problem, settings.noise_differences)


def mean_squared_step(problem: Problem, settings: DiagnosisSettings) -> float:
    """How far the weighted outputs move from one sample to the next, mean square, without what the noise adds to it."""
    return 2.0 * max(_floor(problem, 1) - noise_floor(problem, settings), 0.0)


def _floor(problem: Problem, order: int) -> float:
    factor = float((_binomial(order) ** 2).sum())
    squares, count = 0.0, 0
    for e in range(len(problem.records.first)):
        y = problem.records.y[:, problem.records.span(e)] * problem.weights[:, None]
        rough = np.diff(y, order, axis=1)
        known = rough[~np.isnan(rough)]
        squares, count = squares + float((known**2).sum()), count + known.size
    return squares / factor / max(count, 1)


def output_floors(problem: Problem, settings: DiagnosisSettings) -> np.ndarray:
    """The variance (E, n_y) of white sensor noise by the high-frequency floor of every output, in its unit; NaN where unknown."""
    factor, records = float((_binomial(settings.noise_differences) ** 2).sum()), problem.records
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # an output that is missing throughout an experiment
        rough = [
            np.diff(records.y[:, records.span(e)], settings.noise_differences, axis=1)
            for e in range(len(records.first))
        ]
        return np.array([np.nanmean(r**2, axis=1) for r in rough]) / factor


def _binomial(order: int) -> np.ndarray:
    row = np.ones(1)
    for _ in range(order):
        row = np.convolve(row, [1.0, -1.0])
    return row
