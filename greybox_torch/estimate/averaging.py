"""Means over overlapping stretches of a motion, with weights that fall to zero at both ends (Hann), on several scales."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from greybox_torch.estimate.reconstruction import Motion


@dataclass(frozen=True)
class Stretches:
    """M stretches of L neighbours each, in the order of the records.

    ``index`` (M, L) of what is averaged, ``weights`` (M, L) that add to one, ``middle`` (M,) the intervals in the middle, ``experiment``
    (M,) where they belong, ``step`` the intervals from one to the next where nothing is missing between them.
    """

    index: np.ndarray
    weights: np.ndarray
    middle: np.ndarray
    experiment: np.ndarray
    step: int

    @property
    def count(self) -> int:
        """How many stretches there are."""
        return len(self.index)

    def mean(self, signals: np.ndarray) -> np.ndarray:
        """Weighted means (…, M) of ``signals`` (…, N)."""
        return (signals[..., self.index] * self.weights).sum(axis=-1)

    def coarser(self, factor: int) -> Stretches:
        """Stretches ``factor`` times as long, as means over means of these; spaced by half of their length as well."""
        length = 2 * factor + 1
        first = np.arange(0, max(self.count - length + 1, 0))
        last = first + length - 1
        apart = self.middle[last] - self.middle[first] == (length - 1) * self.step
        first = first[apart & (self.experiment[last] == self.experiment[first])]
        first = _spaced(first, self.experiment, factor)
        index = first[:, None] + np.arange(length)
        weights = np.broadcast_to(np.hanning(length + 2)[1:-1], index.shape)
        weights = weights / weights.sum(axis=1, keepdims=True)
        centre = first + factor
        return Stretches(index, weights, self.middle[centre], self.experiment[centre], factor * self.step)


def stretches(motion: Motion) -> Stretches:
    """Stretches whose means keep what is slower than a motion's cut-off, where all intervals are known.

    Every other one has no interval in common.
    """
    half = max(0, round(0.5 / motion.cutoff) - 1) if motion.cutoff < 0.5 else 0
    length, step = 2 * half + 1, max(1, half)
    lost = np.concatenate([[0], np.cumsum(~motion.known)])
    edges = np.searchsorted(motion.experiment, [*np.unique(motion.experiment), np.inf])
    first = np.concatenate([np.arange(a, b - length + 1, step) for a, b in pairwise(edges)]).astype(np.int64)
    first = first[lost[first + length] == lost[first]]
    index = first[:, None] + np.arange(length)
    weights = np.hanning(length + 2)[1:-1] * motion.dt[index]
    middle = first + half
    return Stretches(index, weights / weights.sum(axis=1, keepdims=True), middle, motion.experiment[middle], step)


def _spaced(first: np.ndarray, experiment: np.ndarray, step: int) -> np.ndarray:
    """Of places in ascending order those that are ``step`` or more apart, or in another experiment."""
    kept: list[int] = []
    for k in first:
        if not kept or k - kept[-1] >= step or experiment[k] != experiment[kept[-1]]:
            kept.append(int(k))
    return np.array(kept, dtype=np.int64)
