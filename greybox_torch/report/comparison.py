"""The figure of a comparison: simulated against measured."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase

from greybox_torch.data import Channel, Recording
from greybox_torch.estimate.divergence import beyond_reach
from greybox_torch.name_lists import listed
from greybox_torch.report.style import MOST_PANELS, STYLE, broken_at_gaps, dots_within, since_start, with_unit
from greybox_torch.report.time_axis import time_unit

Panel = tuple[Recording, Mapping[str, np.ndarray], Mapping[str, str]]
"""A recording, the outputs (N, n_y) by the model's name, and what to say of each model."""

_DETAIL = 0.05
"""Share of the record that the detail shows."""

_MOST_ABREAST = 4
"""Entries of the legend that stand in one row."""

_MARGIN = 0.05
"""Share of its height that an axis has more, each way, than the curves that it is kept to."""

_TITLE = {0: 95, 1: 55}
"""Characters that fit in one line above each column."""


def plot_comparison(
    recording: Recording, outputs: list[Channel], simulated: Mapping[str, np.ndarray], legend: Mapping[str, str]
) -> Figure:
    """One experiment: every output over the whole record, and in detail where the last model is worst, of those that do not
    leave the axes; errors below.

    Args:
        recording: the experiment, with what was measured.
        outputs: names and units of the n_y outputs.
        simulated: the outputs (N, n_y), in these units, by the model's name.
        legend: what to say of each model, by the same names.
    """
    return plot_comparisons([(recording, simulated, legend)], outputs)


def plot_comparisons(panels: Sequence[Panel], outputs: list[Channel]) -> Figure:
    """One experiment below the other, each as :func:`plot_comparison` draws it; of very many the first."""
    panels = panels[: max(MOST_PANELS // (4 * len(outputs)), 1)]
    with mpl.rc_context(STYLE):
        height = (0.6 + 4.4 * len(outputs)) * len(panels)
        figure = Figure(figsize=(11, height), dpi=dots_within(height), layout="constrained")
        parts = figure.subfigures(len(panels), 1, squeeze=False)[:, 0]
        for part, panel in zip(parts, panels, strict=True):
            _plot_panel(part, panel, outputs)
    return figure


def _plot_panel(figure: FigureBase, panel: Panel, outputs: list[Channel]) -> None:
    recording, simulated, legend = panel
    unit = time_unit(recording.seconds)
    time = since_start(recording) / unit.seconds
    figure.suptitle(f"{recording.name} ({recording.role})", fontweight="bold")
    grid = figure.add_gridspec(2 * len(outputs), 2, width_ratios=(1.6, 1), height_ratios=(1.4, 1) * len(outputs))
    for k, output in enumerate(outputs):
        measured = recording.signals[output.name]
        runs = {name: _followed(measured, values[:, k]) for name, values in simulated.items()}
        lost = any(np.isnan(values).any() for values in runs.values())
        within = _within(measured, runs)
        name, last = list((within or runs).items())[-1]
        worst = _worst(measured, last)
        where = (
            "the simulation runs away"
            if np.isnan(last).any()
            else f"the error{f' of {name}' * (len(runs) > 1)} is largest"
        )
        out = [name for name in runs if name not in within]
        leaves = f"{listed(out)} {'leaves' if len(out) == 1 else 'leave'} the axes" if within and out else ""
        for column, (part, title) in enumerate(((slice(None), leaves), (worst, f"where {where}"))):
            above = figure.add_subplot(grid[2 * k, column])
            below = figure.add_subplot(grid[2 * k + 1, column], sharex=above)
            pieces = {legend[name]: values[part] for name, values in runs.items()}
            _plot_signals(above, time[part], measured[part], pieces)
            _plot_errors(below, time[part], measured[part], pieces)
            below.set_xlabel(unit.label)
            if within and out:
                kept = [values[part] for values in within.values()]
                _keep_to(above, [measured[part], *kept])
                _keep_to(below, [measured[part] - values for values in kept])
            elif lost:
                _keep_to_measured(measured, above, below)
            if column == 0:
                above.set_ylabel(with_unit(output.name, output.unit))
                below.set_ylabel(with_unit("error", output.unit))
            above.set_title(textwrap.fill(title, _TITLE[column]), fontsize=9)
    entries = above.get_legend_handles_labels()
    columns = len(entries[0]) if len(entries[0]) <= _MOST_ABREAST else 3
    figure.legend(*entries, loc="outside lower center", ncols=columns)


def _plot_signals(axes: Axes, time: np.ndarray, measured: np.ndarray, runs: Mapping[str, np.ndarray]) -> None:
    axes.plot(*broken_at_gaps(time, measured), color="0.75", linewidth=3.0, label="measured")
    for label, values in runs.items():
        axes.plot(*broken_at_gaps(time, values), linewidth=0.9, label=label)
    axes.margins(x=0)
    axes.tick_params(labelbottom=False)


def _plot_errors(axes: Axes, time: np.ndarray, measured: np.ndarray, runs: Mapping[str, np.ndarray]) -> None:
    axes.axhline(0.0, color="black", linewidth=0.6)
    for values in runs.values():
        axes.plot(*broken_at_gaps(time, measured - values), linewidth=0.8)
    axes.margins(x=0)


def _followed(measured: np.ndarray, simulated: np.ndarray) -> np.ndarray:
    """Where a simulation overflows or runs away, its curve ends, and the axes stay with the measured signal."""
    return np.where(beyond_reach(measured, simulated), np.nan, simulated)


def _within(measured: np.ndarray, runs: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The simulations that stay as near to the measured signal as that is wide: the others are lines beside one far off."""
    span = float(np.ptp(measured[np.isfinite(measured)])) if np.isfinite(measured).any() else 0.0
    near = {name: values for name, values in runs.items() if not np.isnan(values).any()}
    return {name: values for name, values in near.items() if np.nanmax(np.abs(measured - values), initial=0.0) <= span}


def _keep_to(axes: Axes, curves: Sequence[np.ndarray]) -> None:
    """Axes of the size of these curves, which others leave."""
    values = np.concatenate([curve[np.isfinite(curve)] for curve in curves])
    if values.size and (span := float(np.ptp(values))) > 0.0:
        axes.set_ylim(float(values.min()) - _MARGIN * span, float(values.max()) + _MARGIN * span)


def _keep_to_measured(measured: np.ndarray, above: Axes, below: Axes) -> None:
    """Axes of the size of the measured signal, which curves that run away leave."""
    low, high = float(np.nanmin(measured)), float(np.nanmax(measured))
    span = (high - low) or 1.0
    above.set_ylim(low - 0.5 * span, high + 0.5 * span)
    below.set_ylim(-span, span)


def _worst(measured: np.ndarray, simulated: np.ndarray) -> slice:
    """The stretch of the record with the largest squared error, or that in which a simulation's curve ends (NaN from there on)."""
    size = max(10, round(_DETAIL * len(measured)))
    if np.isnan(simulated).any():
        begin = min(max(int(np.argmax(np.isnan(simulated))) - size // 2, 0), max(len(measured) - size, 0))
        return slice(begin, begin + size)
    squared = np.nan_to_num(measured - simulated) ** 2
    total = np.cumsum(np.concatenate([[0.0], squared]))
    begin = int(np.argmax(total[size:] - total[:-size])) if len(measured) > size else 0
    return slice(begin, begin + size)
