"""Whether a channel has a sensor's noise, by which a stretch without any is remarkable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_REPEATS = 0.05
"""Share of the steps up to which a channel changes with nearly every sample."""
_LONGEST = 8
"""Equal samples in a row at most, where that is by chance: of a million, with a twentieth of the steps repeats, there are seven."""
LONG = 25
"""Equal samples in a row from which that is remarkable: three times as many."""
_RESOLUTIONS = 4.0
"""Of the smallest step between two samples: how large noise is at least (second differences, the median). An encoder flickers by one count,
and so does a speed that is computed from it."""
_TURNS = 0.5
"""Share of second differences that have another sign than the one before, at least: 0.73 of white noise, few of what is smooth."""
_BLOCK = 20
"""Samples over which noise is looked at in one place."""
_BESIDE = 0.33
"""Of the usual noise: how large it is right beside a stretch, at least. What fades before it is noise in motion alone, and the machine came
to rest."""
_FEWEST = 100
"""Samples that noise is told from."""


@dataclass(frozen=True, eq=False)
class Runs:
    """Samples (N,) as runs of equal ones: (K,) where each begins and how long it is."""

    values: NDArray[np.float64]
    starts: NDArray[np.intp]
    lengths: NDArray[np.intp]

    @classmethod
    def of(cls, values: NDArray[np.float64]) -> Runs:
        """None of the values is missing."""
        starts = np.concatenate([[0], np.flatnonzero(values[1:] != values[:-1]) + 1])
        return cls(values, starts, np.diff(np.append(starts, len(values))))


@dataclass(frozen=True, eq=False)
class Noise:
    """``level`` is the median size of second differences (N - 2,), which are 0 where ``known`` is False."""

    level: float
    second: NDArray[np.float64]
    known: NDArray[np.bool_]

    @property
    def deviation(self) -> float:
        """The standard deviation that white noise of that size has."""
        return self.level / (0.6745 * 6.0**0.5)

    def beside(self, start: int, stop: int) -> bool:
        """Whether it goes on as usual right before and right after the samples [start, stop), as far as there are some."""
        sides = slice(max(start - _BLOCK, 0), max(start - 2, 0)), slice(stop, stop + _BLOCK - 2)
        sizes = [np.abs(self.second[side][self.known[side]]) for side in sides]
        told = [float(np.median(size)) for size in sizes if len(size) >= _BLOCK // 4]
        return bool(told) and min(told) >= _BESIDE * self.level


def noise_of(runs: Runs, doubted: NDArray[np.bool_]) -> Noise | None:
    """Of a channel that changes with nearly every sample, to and fro, by much more than its resolution; None for any other one.

    Args:
        doubted: runs (K,) that are left out.
    """
    out = np.repeat(doubted, runs.lengths)
    rest, lengths = len(out) - int(out.sum()), runs.lengths[~doubted]
    if rest < _FEWEST or rest - len(lengths) > _REPEATS * rest or lengths.max() > _LONGEST:
        return None
    steps = np.diff(runs.values)
    sizes = np.abs(steps[~(out[1:] | out[:-1])])
    sizes = sizes[sizes > 1e-9 * np.ptp(runs.values)]  # no rounding of computed channels
    known = ~(out[2:] | out[1:-1] | out[:-2])
    second = np.where(known, np.diff(steps), 0.0)
    level = float(np.median(np.abs(second[known]))) if known.any() else 0.0
    if not len(sizes) or level < _RESOLUTIONS * float(sizes.min()):
        return None
    pairs = known[1:] & known[:-1]
    turns = second[1:] * second[:-1] < 0.0
    if np.count_nonzero(turns & pairs) < _TURNS * np.count_nonzero(pairs):
        return None
    return Noise(level, second, known)
