"""The figure of a designed recording: the input, what each hypothesis predicts, and how far they lie apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from greybox_torch.report.style import STYLE, dots_within, with_unit
from greybox_torch.report.time_axis import time_unit

STROKE = 5.0
"""Widths that a stroke is long by which one of several curves is drawn."""


@dataclass(frozen=True)
class Feedback:
    """Of a machine under a controller: ``set_points`` (N,) by output, ``driven`` inputs (N,) by input and hypothesis, and by output what
    each hypothesis predicts on the inputs of the first one, ``on_one_input`` (N,).
    """

    set_points: Mapping[str, np.ndarray]
    driven: Mapping[str, Mapping[str, np.ndarray]]
    on_one_input: Mapping[str, Sequence[np.ndarray]]


def plot_design(
    title: str,
    time: np.ndarray,
    inputs: Mapping[str, np.ndarray],
    outputs: Mapping[str, Mapping[str, np.ndarray]],
    units: Mapping[str, str],
    level: Mapping[str, float],
    feedback: Feedback | None = None,
) -> Figure:
    """Inputs (N,), then every output (N,) by the name of the hypothesis, and below it their distance from the first one.

    Args:
        level: by output, the root mean square error of the recordings so far, drawn as a band.
        feedback: where a controller drives inputs. Set points are drawn beside their outputs, and distances are those on one input, as
            rivals are judged by the input that was recorded.
    """
    several = max((len(o) for o in outputs.values()), default=1) > 1
    driven = {} if feedback is None else feedback.driven
    unit = time_unit(float(np.ptp(time)))
    time = time / unit.seconds
    rows = len(inputs) + len(driven) + (2 if several else 1) * len(outputs)
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
        for name, runs in (*driven.items(), *outputs.items()):
            axis = next(panels)
            for k, (label, values) in enumerate(runs.items()):
                _one_of_several(axis, time, values, k, len(runs), label)
            if feedback is not None and name in feedback.set_points:
                axis.plot(time, feedback.set_points[name], "k--", linewidth=0.8, label="set point")
            axis.set_ylabel(with_unit(name, units.get(name, "")))
            if several or feedback is not None:
                _legend_above(axis)
            if several and name in outputs:
                compared = list(runs.values()) if feedback is None else feedback.on_one_input[name]
                told = "" if feedback is None else f"on the input of {next(iter(runs))}; "
                _distances(next(panels), time, compared, units.get(name, ""), level[name], told, next(iter(runs)))
        axes[-1].set_xlabel(unit.label)
    return figure


def _one_of_several(
    axis: Axes, time: np.ndarray, values: np.ndarray, k: int, count: int, label: str = "", colour: str = ""
) -> None:
    """The ``k``-th of curves that may lie on each other: strokes in turn, so that all colours show, over a thin line."""
    colour = colour or f"C{k}"
    axis.plot(time, values, color=colour, linewidth=0.5 if count > 1 else 1.0, label=label if count == 1 else None)
    if count > 1:
        pattern = (-k * STROKE, (STROKE, (count - 1) * STROKE))
        axis.plot(time, values, color=colour, linewidth=1.5, linestyle=pattern, dash_capstyle="butt")
        axis.plot([], [], color=colour, linewidth=1.5, label=label or None)


def _distances(
    axis: Axes, time: np.ndarray, runs: Sequence[np.ndarray], unit: str, level: float, on: str, first: str
) -> None:
    """The other hypotheses minus the ``first`` one, over a band of one error each way."""
    axis.axhspan(-level, level, color="0.85", label=f"{on}error of the recordings so far, ±1 rms")
    for k, values in enumerate(runs[1:]):
        _one_of_several(axis, time, values - runs[0], k, len(runs) - 1, colour=f"C{k + 1}")
    axis.set_ylabel(with_unit("difference", unit))
    axis.set_title(f"difference from {first}", loc="left", fontsize="small")
    _legend_above(axis)


def _legend_above(axis: Axes) -> None:
    """The legend over the panel, where it hides nothing."""
    axis.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, fontsize="small", frameon=False, borderaxespad=0.2
    )
