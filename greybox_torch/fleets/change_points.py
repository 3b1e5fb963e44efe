"""When a machine changed: the points of change of a series of estimates.

Where: by PELT (Killick, Fearnhead and Eckley, Optimal detection of changepoints with a linear computational cost, Journal of the American
Statistical Association 107 (2012) 1590-1598; of the package `ruptures`), with squared errors and the penalty of Yao (Statistics &
Probability Letters 6 (1988) 181-189). Whether: each of them by a test on the stretch between its neighbours. For measured values this is
the likelihood-ratio test for a shift of a normal mean, its significance bounded as by Worsley (Journal of the American Statistical
Association 74 (1979) 365-367): the largest two-sample t over all places of the change, times their number. For what is either there or
not it is Fisher's exact test; the chance that any place gives so unlikely a table is counted, not bounded.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FEWEST = 6
"""Recordings below which no change can be told from chance."""
SHORTEST = 2
"""Recordings that a stretch between changes has at least: one alone may be a failed experiment."""
LEVEL = 0.05
"""Probability that a machine that has not changed is said to have."""

Values = NDArray[np.float64]


@dataclass(frozen=True)
class ChangePoint:
    """The first recording of the new stretch by its ``index``, the means ``before`` and ``after``, and the bound ``p`` on its
    significance.
    """

    index: int
    before: float
    after: float
    p: float


def change_points(values: Values, *, level: float = LEVEL, binary: bool = False) -> tuple[ChangePoint, ...]:
    """The changes of values (n,), in the order of time.

    Args:
        level: probability of a change where there is none. It is shared among the changes that are looked at.
        binary: whether the values are 0 and 1.
    """
    if len(values) < FEWEST or np.ptp(values) == 0.0:
        return ()
    proposed = _pelt(values)
    level /= max(1, len(proposed))
    while proposed:
        tested = list(_tested(values, proposed, chance_of_presence if binary else chance_of_a_shift))
        weakest = max(tested, key=lambda change: change.p)
        if weakest.p <= level:
            return tuple(tested)
        proposed.remove(weakest.index)  # its neighbours are then tested over longer stretches
    return ()


def _pelt(values: Values) -> list[int]:
    """Where an optimal partition has its bounds."""
    from ruptures import Pelt  # takes scipy's optimisers along

    noise = np.median(np.abs(np.diff(values))) / (
        0.6745 * math.sqrt(2.0)
    )  # of differences, which a change hardly moves
    variance = max(float(noise) ** 2, 1e-6 * float(np.var(values)))
    found = Pelt(model="l2", min_size=SHORTEST, jump=1).fit(values).predict(pen=2.0 * variance * math.log(len(values)))
    return [int(index) for index in found[:-1]]


def _tested(values: Values, proposed: list[int], test: Callable[[Values], float]) -> Iterator[ChangePoint]:
    bounds = [0, *proposed, len(values)]
    for begin, index, end in zip(bounds, bounds[1:], bounds[2:], strict=False):
        p = test(values[begin:end])
        yield ChangePoint(index, float(values[begin:index].mean()), float(values[index:end].mean()), p)


def chance_of_a_shift(values: Values) -> float:
    """Bound on the probability of so large a shift somewhere among values (n,) of one normal distribution."""
    n = len(values)
    if n < 2 * SHORTEST:
        return 1.0
    places = np.arange(SHORTEST, n - SHORTEST + 1)
    largest = 0.0
    for k in places:
        first, second = values[:k], values[k:]
        left = float(np.sum((first - first.mean()) ** 2) + np.sum((second - second.mean()) ** 2)) / (n - 2)
        shift = abs(float(first.mean() - second.mean())) / math.sqrt(1.0 / k + 1.0 / (n - k))
        largest = max(largest, shift / math.sqrt(left) if left > 0.0 else math.inf if shift > 0.0 else 0.0)
    from scipy import stats  # a fifth of a second to import

    return min(1.0, float(len(places) * 2.0 * stats.t.sf(largest, n - 2)))


def chance_of_presence(values: Values) -> float:
    """The probability of so unlikely a table somewhere, for values of 0 and 1 in any order that is as likely as any other.

    Exactly: orders are ways through the grid of (recordings, ones among them), and those are counted that pass by no table as unlikely as
    the most unlikely one here.
    """
    n, total = len(values), int(values.sum())
    places = range(SHORTEST, n - SHORTEST + 1)
    if not places or not 0 < total < n:
        return 1.0
    tables = {k: _two_sided(n, total, k) for k in places}
    ones = np.cumsum(values).astype(int)
    least = min(float(tables[k][ones[k - 1]]) for k in places)
    quiet = np.zeros(total + 1)
    quiet[0] = 1.0  # share of the orders that have passed by no such table, by the ones so far
    passed = 0.0
    for k in range(1, n + 1):
        left = n - k + 1
        drawn = (total - np.arange(total + 1)) / left
        quiet = quiet * np.clip(1.0 - drawn, 0.0, 1.0) + np.concatenate(
            [[0.0], (quiet * np.clip(drawn, 0.0, 1.0))[:-1]]
        )
        if k in tables:
            unlikely = tables[k] <= least * (1.0 + 1e-9)
            passed += float(quiet[unlikely].sum())
            quiet[unlikely] = 0.0
    return min(1.0, passed)


def _two_sided(n: int, total: int, k: int) -> Values:
    """Fisher's exact probability of the table with s of the ``total`` ones among the first k of n, for s from 0 to ``total``."""
    from scipy import stats

    chances = stats.hypergeom.pmf(np.arange(total + 1), n, total, k)
    order = np.argsort(chances)
    summed = np.cumsum(chances[order])
    last = np.searchsorted(chances[order], chances * (1.0 + 1e-9), side="right") - 1
    return np.where(chances > 0.0, summed[np.clip(last, 0, None)], 1.0)
