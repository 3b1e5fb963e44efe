"""Differences of successive samples: a smooth motion is next to nothing in them, and noise is as large as it was."""

from __future__ import annotations

import numpy as np

from greybox_torch.data.steps import EVEN

FEWEST_IN_A_ROW, FEWEST_SHARE = 30, 0.1
"""How many stretches of samples without a missing one are enough, or which share of all samples that are there."""


def differences(y: np.ndarray, time: np.ndarray, order: int) -> np.ndarray:
    """Differences (K,) of an output y (N,), NaN where it is missing, at ``time`` (N,) in s; none where it has too few samples.

    White noise of variance 1 has the mean square of :func:`of_white_noise` in them. They are those of samples in a row, or, of an output
    of which hardly any few are in a row, such as a slower sensor's, of the samples that are there, however far apart.

    Where steps are uneven, differences take out of the motion only what they would of even ones, and divided differences what is smooth
    over the stamps; stamps that are rounded tell the times worse than their order does. Both are bounds from above: the smaller counts.
    Seen: a linear encoder of 200 Hz beside a drive's 500 Hz, whose samples stand 2 and 3 rows apart in turn: 5 µm of noise were 290 µm.
    """
    if len(y) <= order:
        return np.empty(0)
    there = ~np.isnan(y)
    in_a_row = np.convolve(there, np.ones(order + 1, dtype=int), "valid") == order + 1
    if in_a_row.sum() < min(FEWEST_IN_A_ROW, FEWEST_SHARE * there.sum()):
        y, time, in_a_row = y[there], time[there], np.ones(max(int(there.sum()) - order, 0), dtype=bool)
    plain = np.diff(y, order)[in_a_row]
    steps = np.diff(time)
    if not len(plain) or np.ptp(steps) <= EVEN * np.median(steps):
        return plain
    divided = _divided(y, time, order)[in_a_row]
    return divided if np.sum(divided**2) < np.sum(plain**2) else plain


def of_white_noise(order: int) -> float:
    """The mean square of :func:`differences` of white noise of variance 1."""
    return float((_binomial(order) ** 2).sum())


def _divided(y: np.ndarray, time: np.ndarray, order: int) -> np.ndarray:
    """Divided differences (N - ``order``,) at uneven ``time`` (N,), in the unit in which noise is in those of even samples.

    Source: J. Stoer, R. Bulirsch, Introduction to Numerical Analysis, 3rd ed., 2002, section 2.1.3.
    """
    count = len(y) - order
    stamps = [time[k : k + count] for k in range(order + 1)]
    apart, divided, squares = stamps[-1] - stamps[0], np.zeros(count), np.zeros(count)
    for k, own in enumerate(stamps):  # one at a time: of a long recording all weights at once are hundreds of megabytes
        weights = np.ones(count)
        for other in (*stamps[:k], *stamps[k + 1 :]):
            weights *= apart / (own - other)
        divided += weights * y[k : k + count]
        squares += weights**2
    return np.sqrt(of_white_noise(order) / squares) * divided


def _binomial(order: int) -> np.ndarray:
    row = np.ones(1)
    for _ in range(order):
        row = np.convolve(row, [1.0, -1.0])
    return row
