"""How large the noise of a recording is, from the recording alone."""

from __future__ import annotations

import warnings

import numpy as np

from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulation.records import Records, once


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
    """Whether the recordings tell how much noise there is: differences of several orders agree on it, and no fit leaves less.

    What is left of the motion in them would not be the same in each.
    """
    if problem.most_noise is not None:
        return False
    first = settings.noise_differences
    floors = [_floor(problem, order) for order in (first, first + 1, first + 2)]
    return max(floors) < settings.noise_floors_agree * min(floors)


def noise_floor(problem: Problem, settings: DiagnosisSettings) -> float:
    """Mean squared weighted error that white sensor noise alone would leave, as the outputs' high-frequency floor has it.

    The variance of the third differences of white noise is 20 times its own. Where the sampling is so slow that the motion itself is
    rough, or inputs act on the outputs at once, this is an upper bound; so is what a fit leaves of an output (:func:`most_noise`).

    Source: J. von Neumann et al., "The mean square successive difference", Annals of Mathematical Statistics 12, 1941.
    """
    if problem.most_noise is None:
        return _floor(problem, settings.noise_differences)
    known = (~np.isnan(problem.records.y)).sum(axis=1)
    each = np.nan_to_num(_over_experiments(problem, settings)) * problem.weights**2
    return float(known @ each / max(known.sum(), 1))


def most_noise(fit: WindowFit, left: np.ndarray, settings: DiagnosisSettings) -> np.ndarray | None:
    """The largest variance (n_y,) that the noise of each output can have where a fit leaves much less than the recordings' floor of it,
    infinite elsewhere; None where it does so of no output.

    A battery's voltage jumps with its current: what looks like noise in the recording is what the model says.

    Args:
        left: the mean squared errors (n_y,) of the fit, in output units.
    """
    problem, samples = fit.problem, fit.windows.steps * len(left)
    left = left * samples / max(samples - len(problem.model.states), 1)
    less = _over_experiments(problem, settings) > settings.noise_disproved * left
    return np.where(less, left, np.inf) if less.any() else None


def mean_squared_step(problem: Problem, settings: DiagnosisSettings) -> float:
    """How far the weighted outputs move from one sample to the next, mean square, without what the noise adds to it."""
    return 2.0 * max(_floor(problem, 1) - noise_floor(problem, settings), 0.0)


def _floor(problem: Problem, order: int) -> float:
    records, weights = problem.records, problem.weights
    return once(records, ("floor", order, weights.tobytes()), lambda: _measured_floor(records, weights, order))


def _measured_floor(records: Records, weights: np.ndarray, order: int) -> float:
    factor = float((_binomial(order) ** 2).sum())
    squares, count = 0.0, 0
    for e in range(len(records.first)):
        y = records.y[:, records.span(e)] * weights[:, None]
        rough = np.diff(y, order, axis=1)
        known = rough[~np.isnan(rough)]
        squares, count = squares + float((known**2).sum()), count + known.size
        for slow in y[np.isnan(rough).all(axis=1)]:
            apart = _differences(slow, order)
            squares, count = squares + float((apart**2).sum()), count + apart.size
    return squares / factor / max(count, 1)


def output_floors(problem: Problem, settings: DiagnosisSettings) -> np.ndarray:
    """The variance (E, n_y) of white sensor noise by the high-frequency floor of every output, in its unit; NaN where unknown."""
    records, order = problem.records, settings.noise_differences
    spans = [records.span(e) for e in range(len(records.first))]
    found = np.array([[_rough(y, order) for y in records.y[:, span]] for span in spans])
    found /= float((_binomial(order) ** 2).sum())
    return found if problem.most_noise is None else np.minimum(found, problem.most_noise)


def _rough(y: np.ndarray, order: int) -> float:
    """The mean square of the differences of samples (N,) in a row; NaN where there are none."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # an output that is missing throughout an experiment
        in_a_row = np.diff(y, order)
        return float(np.nanmean((_differences(y, order) if np.isnan(in_a_row).all() else in_a_row) ** 2))


def _differences(slow: np.ndarray, order: int) -> np.ndarray:
    """Those of the samples (N,) that are there, for an output from a slower file, of which no few in a row are."""
    return np.diff(slow[~np.isnan(slow)], order)


def _over_experiments(problem: Problem, settings: DiagnosisSettings) -> np.ndarray:
    """The mean (n_y,) of :func:`output_floors` over the experiments; NaN where no experiment shows an output."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.nanmean(output_floors(problem, settings), axis=0)


def _binomial(order: int) -> np.ndarray:
    row = np.ones(1)
    for _ in range(order):
        row = np.convolve(row, [1.0, -1.0])
    return row
