"""Samples that a page carries along, so that a reader can look closer: bounded in size, whatever the length of the record."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

MOST_VALUES = 500_000
"""Values that all charts of a page carry together, two bytes each."""

LEVELS = 65534
"""Steps into which a series is divided between its extremes; one more stands for a missing value."""

EVEN = 1e-4
"""Deviation of time stamps from even ones, in steps, below which they are taken as even."""


@dataclass(frozen=True)
class Samples:
    """Series over the time (N,) of one experiment in s, by the name that panels call them by. ``experiment`` is one number for all charts
    that are looked at together.
    """

    experiment: int
    time: np.ndarray
    series: Mapping[str, np.ndarray]

    def text(self, most: int) -> str:
        """As JSON: every series with at most so many values, as the extremes of successive stretches where it has more samples."""
        size = max(1, -(-2 * len(self.time) // max(most, 2))) if len(self.time) > most else 1
        clock = self.time[::size]
        even = len(clock) < 3 or float(np.ptp(np.diff(clock))) < EVEN * float(np.median(np.diff(clock)))
        told: dict[str, object] = {
            "experiment": self.experiment,
            "time": [float(self.time[0]), float(self.time[-1])],
            "paired": size > 1,
            "series": {name: _packed(_extremes(values, size)) for name, values in self.series.items()},
        }
        told |= (
            {"step": float(np.median(np.diff(clock))) if len(clock) > 1 else 1.0} if even else {"clock": _packed(clock)}
        )
        # nothing in it may end the element that it stands in
        return json.dumps(told, separators=(",", ":")).replace("<", "\\u003c")


def share_of_each(charts: int, series: int) -> int:
    """Values that a series may have, with so many charts of so many series on the page."""
    return MOST_VALUES // max(charts * series, 1)


def _extremes(values: np.ndarray, size: int) -> np.ndarray:
    """The smallest and the largest value of every stretch of ``size`` samples, one after the other; NaN where none is finite."""
    finite = np.where(np.isfinite(values), values, np.nan)
    if size == 1:
        return finite
    count = -(-len(finite) // size)
    padded = np.full(count * size, np.nan)
    padded[: len(finite)] = finite
    boxes = padded.reshape(count, size)
    missing = ~np.isfinite(boxes).any(axis=1)
    low = np.where(np.isnan(boxes), np.inf, boxes).min(axis=1)
    high = np.where(np.isnan(boxes), -np.inf, boxes).max(axis=1)
    return np.where(missing.reshape(-1, 1), np.nan, np.stack([low, high], axis=1)).ravel()


def _packed(values: np.ndarray) -> dict[str, object]:
    """Values in 16 bits between their extremes."""
    known, values = np.isfinite(values), np.clip(values, -1e100, 1e100)
    low = float(values[known].min()) if known.any() else 0.0
    high = float(values[known].max()) if known.any() else 0.0
    reach = high - low if np.isfinite(high - low) and high > low else 1.0
    steps = np.where(known, np.round((np.where(known, values, low) - low) / reach * LEVELS), LEVELS + 1)
    return {"low": low, "reach": reach, "data": b64encode(steps.astype("<u2").tobytes()).decode()}
