"""The figure of residuals: over time, their autocorrelation, and their correlation with the inputs."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from greybox_torch.estimate.residuals import Correlation, Residuals
from greybox_torch.report.style import (
    MOST_PANELS,
    STYLE,
    dots_within,
    plot_samples,
    shown_of,
    since_start,
    with_unit,
)
from greybox_torch.report.time_axis import time_unit


def plot_residuals(rows: Sequence[Residuals], title: str) -> Figure:
    """A row for each output of each experiment; the band is what 99 % of the values keep within if nothing is missing.

    Of very many rows the figure shows the first, and says so.

    Args:
        rows: errors with their correlations, such as ``evaluate(data).residuals``.
        title: of the figure.
    """
    columns = 2 + max(len(row.inputs) for row in rows)
    title += shown_of("rows", min(len(rows), MOST_PANELS // 3), len(rows))
    rows = rows[: MOST_PANELS // 3]
    height = 1.4 + 1.5 * len(rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.0 * columns, height), dpi=dots_within(height), layout="constrained")
        figure.suptitle(title, fontweight="bold")
        axes = figure.subplots(len(rows), columns, squeeze=False)
        for row, places in zip(rows, axes, strict=True):
            _plot_errors(places[0], row)
            _plot_correlation(places[1], row.whiteness, "autocorrelation")
            for place, (name, correlation) in zip(places[2:], row.inputs.items(), strict=True):
                _plot_correlation(place, correlation, f"correlation with {name} earlier by the lag")
        _label_once(axes)
        figure.legend(*axes[0, 1].get_legend_handles_labels(), loc="outside lower center")
    return figure


def _label_once(axes: np.ndarray) -> None:
    """A column has its label at the foot, and its title at the top where all rows have the same; a row for each output would be high."""
    for k, column in enumerate(axes.T):
        for below in column[1:]:
            if k > 0 and below.get_title() == column[0].get_title():
                below.set_title("")
        for above in column[:-1]:
            above.set_xlabel("")


def _plot_errors(axes: Axes, row: Residuals) -> None:
    unit = time_unit(row.recording.seconds)
    plot_samples(axes, since_start(row.recording) / unit.seconds, row.errors, linewidth=0.6)
    axes.margins(x=0)
    axes.set_title(f"{row.recording.name} ({row.recording.role})")
    axes.set_xlabel(unit.label)
    axes.set_ylabel("residual of\n" + with_unit(row.output.name, row.output.unit))


def _plot_correlation(axes: Axes, correlation: Correlation, title: str) -> None:
    axes.axhspan(-correlation.bound, correlation.bound, color="tab:green", alpha=0.25, linewidth=1, label="99 % band")
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.vlines(correlation.lags, 0.0, correlation.values, linewidth=1.0)
    axes.plot(correlation.lags, correlation.values, "o", markersize=3)
    reach = 1.15 * max(float(np.abs(correlation.values).max()), correlation.bound)
    axes.set_ylim(-reach, reach)
    axes.set_title(title)
    axes.set_xlabel("lag [samples]")
