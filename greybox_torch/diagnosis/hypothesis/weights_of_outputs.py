"""Whole records of several outputs, each weighed by what the model leaves of it.

Over short windows a model that lacks something may follow a sensor to its noise and leave far more of it over whole records. With weights
by the short windows that output alone is fitted, and the re-estimated model follows another worse than it can. Seen: a lift whose current
has little noise; its speed was followed by -29 % where other parameters follow it by 58 %.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.estimate.free_run import FreeRun, descended
from greybox_torch.estimate.levenberg_marquardt import Settings

ROUNDS = 3
"""How often the weights are set to what the fit with those before them leaves."""

ALIKE = 1.5
"""Ratio between the outputs' changes of weight up to which the fit stands."""

LEAST = 0.01
"""By how much the logarithm of what is left has to fall for another round to be worth its time."""


def weighed_by_what_is_left(run: FreeRun, point: np.ndarray, settings: Settings) -> tuple[FreeRun, np.ndarray]:
    """The run and its unknowns (d,) with the outputs' errors in units of what is left of each: the likeliest fit where each output has a
    variance of its own, which is what the model leaves of it. As they are where that follows the outputs worse, in units of their spread:
    one that is followed to its noise may take all the weight.

    Source: Y. Bard, Nonlinear Parameter Estimation, 1974, section 4-9 (unknown diagonal covariance).
    """
    if len(run.problem.weights) < 2 or not len(point):
        return run, point
    left = _left(run, point)
    for _ in range(ROUNDS):
        if left is None or _alike(left * run.problem.weights):
            break
        anew = replace(run, problem=replace(run.at(point), weights=1.0 / left))
        ended = descended(anew, anew.start, settings)
        after = None if ended is None else _left(anew, ended.point)
        if ended is None or after is None or not _better(after, left, np.nanstd(run.problem.records.y, axis=1)):
            break
        run, point, left = anew, ended.point, after
    return run, point


def _better(after: np.ndarray, before: np.ndarray, spread: np.ndarray) -> bool:
    """Whether less is left, in the logarithm and in units of the spread (n_y,) of those outputs that move."""
    moves = spread > 0
    in_spread = [float(((left[moves] / spread[moves]) ** 2).sum()) for left in (after, before)]
    return in_spread[0] <= in_spread[1] and bool(np.log(after).sum() < np.log(before).sum() - LEAST)


def _alike(ratios: np.ndarray) -> bool:
    """Whether weights would change by about the same factor."""
    return bool(ratios.max() <= ALIKE * ratios.min())


def _left(run: FreeRun, point: np.ndarray) -> np.ndarray | None:
    """Root mean square errors (n_y,) over all experiments, in the outputs' units; None where they cannot be simulated or one is zero."""
    found = run.errors(point)
    if found is None:
        return None
    errors = np.concatenate([errors for errors, _ in found]) / run.problem.weights  # zero where nothing was measured
    left = np.sqrt((errors**2).sum(axis=0) / np.maximum((~np.isnan(run.problem.records.y)).sum(axis=1), 1))
    return left if np.isfinite(left).all() and (left > 0).all() else None
