"""How large the noise of a recording is, from the recording alone."""

from __future__ import annotations

import warnings

import numpy as np

from greybox_torch.diagnosis.hypothesis.differences import differences, of_white_noise
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
    each = np.nan_to_num(over_experiments(problem, settings)) * problem.weights**2
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
    less = over_experiments(problem, settings) > settings.noise_disproved * left
    return np.where(less, left, np.inf) if less.any() else None


def mean_squared_step(problem: Problem, settings: DiagnosisSettings) -> float:
    """How far the weighted outputs move from one sample to the next, mean square, without what the noise adds to it."""
    return 2.0 * max(_floor(problem, 1) - noise_floor(problem, settings), 0.0)


def _floor(problem: Problem, order: int) -> float:
    records, weights = problem.records, problem.weights
    return once(records, ("floor", order, weights.tobytes()), lambda: _measured_floor(records, weights, order))


def _measured_floor(records: Records, weights: np.ndarray, order: int) -> float:
    squares, count = 0.0, 0
    for e in range(len(records.first)):
        for y, weight in zip(records.y[:, records.span(e)], weights, strict=True):
            rough = weight * differences(y, records.time(e), order)
            squares, count = squares + float((rough**2).sum()), count + rough.size
    return squares / of_white_noise(order) / max(count, 1)


def output_floors(problem: Problem, settings: DiagnosisSettings) -> np.ndarray:
    """The variance (E, n_y) of white sensor noise by the high-frequency floor of every output, in its unit; NaN where unknown."""
    records, order = problem.records, settings.noise_differences
    found = once(records, ("floors", order), lambda: _measured_floors(records, order))
    return found.copy() if problem.most_noise is None else np.minimum(found, problem.most_noise)


def _measured_floors(records: Records, order: int) -> np.ndarray:
    found = [_of_outputs(records, e, order) for e in range(len(records.first))]
    return np.array(found) / of_white_noise(order)


def _of_outputs(records: Records, experiment: int, order: int) -> list[float]:
    """The mean squares (n_y,) of the differences of the outputs in an experiment; NaN where there are none."""
    time, rows = records.time(experiment), records.y[:, records.span(experiment)]
    rough = (differences(y, time, order) for y in rows)
    return [float(np.mean(r**2)) if r.size else np.nan for r in rough]


def over_experiments(problem: Problem, settings: DiagnosisSettings) -> np.ndarray:
    """The mean (n_y,) of :func:`output_floors` over the experiments; NaN where no experiment shows an output."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.nanmean(output_floors(problem, settings), axis=0)
