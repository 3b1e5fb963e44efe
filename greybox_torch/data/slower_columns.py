"""Columns with a sample in every k-th row alone, as of a slower sensor that is logged with faster ones, and empty cells between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.expression import Expression
from greybox_torch.data.gaps import in_gaps, without_gaps
from greybox_torch.data.processing import SLOWER, at_times
from greybox_torch.data.source import Source

_FEWEST = 4
"""Samples that tell that a column is regular."""

_REGULAR = 0.9
"""Share of the steps from sample to sample that are the usual one within half of it; samples that are lost at random are not so even."""

_RESTING = 0.5
"""Share of these steps up to which a value may change to be taken for one that is set, and held until the next sample."""


@dataclass(frozen=True, eq=False)
class SlowerColumn:
    """``values`` (N,) between the samples too, NaN before the first and where several are lost in a row; ``between`` (N,) marks the values
    that are no samples. ``note`` says what was done.
    """

    values: NDArray[np.float64]
    between: NDArray[np.bool_]
    note: str


def slower_column(name: str, time: NDArray[np.float64], values: NDArray[np.float64]) -> SlowerColumn | None:
    """The channel ``name`` with values (N,) at ``time`` (N,) in s, NaN where there is none; None where it is no regular slower one.

    Between samples it runs on straight lines, as columns of a slower file do. What hardly ever changes from sample to sample, such as a
    set point, is held.
    """
    known = ~np.isnan(values)
    stamps, samples = time[known], values[known]
    if len(stamps) < _FEWEST or known.all():
        return None
    steps = without_gaps(stamps)
    usual = float(np.median(steps))
    if usual < SLOWER * np.median(np.diff(time)) or np.mean(np.abs(steps / usual - 1.0) < 0.5) < _REGULAR:
        return None
    held = np.mean(np.diff(samples) != 0.0) <= _RESTING
    filled = _held(time, stamps, samples, usual) if held else at_times(time, stamps, samples)
    filled = np.where(in_gaps(time, stamps), np.nan, filled)
    how = "held from one to the next, as it rarely changes" if held else "on straight lines between them"
    return SlowerColumn(filled, ~known & ~np.isnan(filled), f"{name} has a sample every {usual:.4g} s alone: {how}")


def _held(
    time: NDArray[np.float64], stamps: NDArray[np.float64], samples: NDArray[np.float64], usual: float
) -> NDArray[np.float64]:
    """The sample before, up to one usual step behind the last."""
    before = np.searchsorted(stamps, time, side="right") - 1
    inside = (before >= 0) & (time <= stamps[-1] + usual)
    return np.where(inside, samples[before], np.nan)


def between_of(
    source: Source, formulas: Mapping[str, Expression], rows: tuple[int, int]
) -> dict[str, NDArray[np.bool_]]:
    """By channel, the samples at which one of its columns lies between samples of a slower file."""
    of = {
        name: [source.between[c] for c in formula.columns if c in source.between] for name, formula in formulas.items()
    }
    return {name: np.any(columns, axis=0)[slice(*rows)] for name, columns in of.items() if columns}
