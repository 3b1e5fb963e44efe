"""What all figures have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from greybox_torch.data import Recording
from greybox_torch.data.gaps import gap_steps

if TYPE_CHECKING:  # the style of figures is known without drawing any
    from matplotlib.axes import Axes

STYLE: dict[Any, Any] = {
    "text.parse_math": False,  # a name may hold dollar signs
    "agg.path.chunksize": 20000,  # long records overflow the renderer otherwise
    "axes.grid": True,
    "grid.alpha": 0.3,
    "font.size": 9,
}
"""Settings for ``matplotlib.rc_context``."""


def dots_within(height: float) -> float:
    """Dots per inch of a figure of this height in inches: a picture ends at 65536 dots, reached by hundreds of experiments."""
    return min(120.0, 50000.0 / height)


def since_start(recording: Recording) -> np.ndarray:
    """Seconds since a recording's first sample (N,), for an axis: stamps may be dates, of which seconds since 1970 nobody can read."""
    return recording.time - recording.time[0]


def broken_at_gaps(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and values (N,) with a value that is none after every sample that a gap follows, so that no line is drawn across it."""
    after = np.flatnonzero(gap_steps(time)) + 1
    return np.insert(time, after, time[after - 1]), np.insert(values.astype(float), after, np.nan)


def plot_samples(axes: Axes, time: np.ndarray, values: np.ndarray, linewidth: float) -> None:
    """A line through samples (N,), and dots where one stands between two missing ones, through which no line goes."""
    axes.plot(*broken_at_gaps(time, values), linewidth=linewidth)
    gone = np.concatenate([[True], np.isnan(values), [True]])
    alone = gone[:-2] & ~gone[1:-1] & gone[2:]
    if alone.any():
        axes.plot(time[alone], values[alone], ".", color="tab:blue", markersize=2.0)


def with_unit(name: str, unit: str) -> str:
    """A label for an axis."""
    return f"{name} [{unit}]" if unit else name


MOST_PANELS = 72
"""Panels that one figure shows. What a layout of many hundreds would take is hours, and nobody could read it."""


def shown_of(what: str, shown: int, there: int) -> str:
    """Ends a title: how many of something the figure shows; empty where that is all."""
    return "" if shown == there else f" (the first {shown} of {there} {what})"
