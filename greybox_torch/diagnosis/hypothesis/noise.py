"""How large the noise of a recording is, from the recording alone."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from greybox_torch.estimate.problem import Problem

if TYPE_CHECKING:
    from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
    from greybox_torch.estimate.window_fit import WindowFit

DIFFERENCES = 3
"""How many times the outputs are differenced: what a machine does is smooth at the rate it is sampled at, noise is not."""

FLOORS_AGREE = 1.05
"""Ratio of the noises that differences of several orders show up to which they agree."""

AT_NOISE = 1.0
"""How many times the mean square of the noise an error may have to be noise alone. (Under feedback the noise shakes the machine as well,
which the differences count and a model explains: the floor is a few per cent high.)"""

ABOVE_NOISE = 1.3
"""How many times the noise an error must be to count as more than noise."""

NOISE_REACHED = 1.05
"""How many times the noise a root mean square error may be to count as noise alone where hypotheses are compared."""

FAR_ABOVE_NOISE = 3.0
"""How many times the noise an error is far above it: laws that leave so much are not the whole story."""


def times_noise(problem: Problem, fitted: Hypothesis) -> float:
    """Root mean square error in units of the noise, over the windows where it is largest: long ones show what is slow."""
    return float(np.sqrt(max(f.mean_square for f in fitted.fits) / max(noise_floor(problem), 1e-300)))


def far_above_noise(fitted: Hypothesis) -> bool:
    """Whether a hypothesis leaves much more than the noise."""
    return times_noise(fitted.problem, fitted) > FAR_ABOVE_NOISE


def reaches_noise(problem: Problem, fit: WindowFit, times: float = NOISE_REACHED) -> bool:
    """Whether a fit leaves white noise alone, where the recordings tell how much of it there is."""
    return floor_known(problem) and fit.mean_square < times**2 * noise_floor(problem)


def noise_over_windows(fitted: Hypothesis) -> bool:
    """Whether a fit leaves hardly more than noise over windows, the longest aside, where slow disturbances of the machine show."""
    return all(reaches_noise(fitted.problem, fit, ABOVE_NOISE) for fit in fitted.fits[:-1] or fitted.fits)


def only_noise(problem: Problem, fitted: Hypothesis) -> bool:
    """Whether nothing but noise is left at any window length, where the recordings tell how much of it there is."""
    return floor_known(problem) and max(f.mean_square for f in fitted.fits) < AT_NOISE * noise_floor(problem)


def floor_known(problem: Problem) -> bool:
    """Whether the recordings tell how much noise there is: differences of several orders agree on it.

    What is left of the motion in them would not be the same in each.
    """
    floors = [noise_floor(problem, order) for order in (DIFFERENCES, DIFFERENCES + 1, DIFFERENCES + 2)]
    return max(floors) < FLOORS_AGREE * min(floors)


def noise_floor(problem: Problem, order: int = DIFFERENCES) -> float:
    """Mean squared weighted error that white sensor noise alone would leave, as the outputs' high-frequency floor has it.

    The variance of the third differences of white noise is 20 times its own. Where the sampling is so slow that the motion itself is
    rough, this is an upper bound.

    Source: J. von Neumann et al., "The mean square successive difference", Annals of Mathematical Statistics 12, 1941.
    """
    factor = float((_binomial(order) ** 2).sum())
    squares, count = 0.0, 0
    for e in range(len(problem.records.first)):
        y = problem.records.y[:, problem.records.span(e)] * problem.weights[:, None]
        rough = np.diff(y, order, axis=1)
        known = rough[~np.isnan(rough)]
        squares, count = squares + float((known**2).sum()), count + known.size
    return squares / factor / max(count, 1)


def output_floors(problem: Problem) -> np.ndarray:
    """The variance (E, n_y) of white sensor noise by the high-frequency floor of every output, in its unit; NaN where unknown."""
    factor, records = float((_binomial(DIFFERENCES) ** 2).sum()), problem.records
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # an output that is missing throughout an experiment
        rough = [np.diff(records.y[:, records.span(e)], DIFFERENCES, axis=1) for e in range(len(records.first))]
        return np.array([np.nanmean(r**2, axis=1) for r in rough]) / factor


def _binomial(order: int) -> np.ndarray:
    row = np.ones(1)
    for _ in range(order):
        row = np.convolve(row, [1.0, -1.0])
    return row
