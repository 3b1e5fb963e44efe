"""What machines of one kind have in common, and how far each of them is from it: a random-effects estimate with shrinkage.

DerSimonian and Laird, Meta-analysis in clinical trials, Controlled Clinical Trials 7 (1986) 177-188: each machine's true value is drawn
about the fleet's mean with a standard deviation between machines that is estimated by moments. Outliers by the deleted residuals of
Viechtbauer and Cheung, Outlier and influence diagnostics for meta-analysis, Research Synthesis Methods 1 (2010) 112-125: each machine is
compared with the others alone, so that it does not hide itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FEWEST = 5
"""Machines below which a deviation between them says too little."""
LEVEL = 0.05
"""Probability that a fleet without any outlier is said to have one."""

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Common:
    """A parameter over n machines, in its unit.

    ``mean`` with its standard deviation ``std``; ``between``, the standard deviation between machines; ``shrunken`` (n,), each machine's
    own value drawn towards the mean as far as it is uncertain; ``residuals`` (n,), by how many standard deviations it is away from what
    the others predict; ``outlying`` (n,), whether that is more than chance for so many machines.
    """

    mean: float
    std: float
    between: float
    shrunken: Values
    residuals: Values
    outlying: NDArray[np.bool_]


def common(values: Values, deviations: Values) -> Common:
    """The random-effects estimate of values (n,) with standard deviations (n,), n at least :data:`FEWEST`, all finite.

    Deleted residuals are compared with Student's t of n - 2 degrees of freedom, as the deviation between machines is itself estimated, at
    the level :data:`LEVEL` shared among the machines (Bonferroni).
    """
    from scipy import stats  # a fifth of a second to import

    variances = deviations**2
    mean, variance, between = _moments(values, variances)
    spread = between**2 + variances
    pull = np.divide(between**2, spread, out=np.ones_like(spread), where=spread > 0.0)
    residuals = np.array([_deleted_residual(values, variances, k) for k in range(len(values))])
    bound = float(stats.t.isf(LEVEL / (2.0 * len(values)), len(values) - 2))
    shrunken = pull * values + (1.0 - pull) * mean
    return Common(mean, math.sqrt(variance), between, shrunken, residuals, np.abs(residuals) > bound)


def _moments(values: Values, variances: Values) -> tuple[float, float, float]:
    """Mean, its variance, and the standard deviation between machines."""
    floor = 1e-12 * float(np.mean(values**2)) + np.finfo(float).tiny  # deviations of zero are no infinite weights
    within = np.maximum(variances, floor)
    weights = 1.0 / within
    fixed = np.average(values, weights=weights)
    spread = float(np.sum(weights * (values - fixed) ** 2))
    room = float(np.sum(weights) - np.sum(weights**2) / np.sum(weights))
    between = max(0.0, (spread - (len(values) - 1)) / room)
    weights = 1.0 / (within + between)
    return float(np.average(values, weights=weights)), float(1.0 / np.sum(weights)), math.sqrt(between)


def _deleted_residual(values: Values, variances: Values, k: int) -> float:
    others = np.arange(len(values)) != k
    mean, variance, between = _moments(values[others], variances[others])
    expected = math.sqrt(variance + between**2 + variances[k])
    distance = float(values[k] - mean)
    return distance / expected if expected > 0.0 else 0.0 if distance == 0.0 else math.copysign(math.inf, distance)
