"""The figure of a designed recording: the input, what each hypothesis predicts, and how far they lie apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from greybox_torch.report.style import STYLE, dots_within, with_unit


def plot_design(
    title: str,
    time: np.ndarray,
    inputs: Mapping[str, np.ndarray],
    outputs: Mapping[str, Mapping[str, np.ndarray]],
    units: Mapping[str, str],
    level: Mapping[str, float],
) -> Figure:
    """Inputs (N,), then every output (N,) by the name of the hypothesis, and below it their distance from the first one.

    Args:
        level: by output, the root mean square error of the recordings so far, drawn as a band.
    """
    several = max((len(o) for o in outputs.values()), default=1) > 1
    rows = len(inputs) + (2 if several else 1) * len(outputs)
    with mpl.rc_context(STYLE):
        height = 0.6 + 1.7 * rows
        figure = Figure(figsize=(11, height), dpi=dots_within(height), layout="constrained")
        figure.suptitle(title, fontweight="bold")
        axes = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
        panels = iter(axes)
        for name, values in inputs.items():
            axis = next(panels)
            axis.plot(time, values, color="0.25", linewidth=1.0)
            axis.set_ylabel(with_unit(name, units.get(name, "")))
        for name, runs in outputs.items():
            axis, labels = next(panels), list(runs)
            for label, values in runs.items():
                axis.plot(time, values, linewidth=1.0, label=label)
            axis.set_ylabel(with_unit(name, units.get(name, "")))
            if several:
                _legend_above(axis)
                _distances(next(panels), time, [runs[label] for label in labels], units.get(name, ""), level[name])
        axes[-1].set_xlabel("time [s]")
    return figure


def _distances(axis: Axes, time: np.ndarray, runs: Sequence[np.ndarray], unit: str, level: float) -> None:
    """The other hypotheses minus the first one, over a band of one error each way."""
    axis.axhspan(-level, level, color="0.85", label="error of the recordings so far, ±1 rms")
    axis.plot([], [])  # the first hypothesis has the first colour
    for values in runs[1:]:
        axis.plot(time, values - runs[0], linewidth=1.0)
    axis.set_ylabel(with_unit("difference", unit))
    _legend_above(axis)


def _legend_above(axis: Axes) -> None:
    """The legend over the panel, where it hides nothing."""
    axis.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, fontsize="small", frameon=False, borderaxespad=0.2
    )
