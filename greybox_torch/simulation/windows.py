"""Stretches of records that are simulated side by side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.simulation.records import Records


@dataclass(frozen=True)
class Windows:
    """Which stretch of the records each of W windows covers: first sample (W,), last sample it may read (W,), steps of the longest."""

    start: np.ndarray
    last: np.ndarray
    steps: int


def whole_records(records: Records) -> Windows:
    """One window per experiment: the free run."""
    return Windows(records.first, records.last, int(records.lengths.max()))


def cut(records: Records, length: int) -> Windows:
    """All experiments cut into windows of ``length`` samples, each beginning at a multiple of it.

    A remainder shorter than half a window is joined to the window before it: the longest, which ``steps`` counts, may be longer.
    """
    starts: list[int] = []
    lasts: list[int] = []
    for first, last in zip(records.first, records.last, strict=True):
        total = int(last - first + 1)
        count = max(1, int(total / length + 0.5))
        begins = [int(first) + k * length for k in range(count)]
        starts += begins
        lasts += [b - 1 for b in begins[1:]] + [int(last)]
    sizes = np.array(lasts) - np.array(starts) + 1
    return Windows(np.array(starts), np.array(lasts), int(sizes.max()))
