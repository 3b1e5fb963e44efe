"""A picture of what moves which output."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from greybox_torch.report.style import STYLE, dots_within


def plot_influence(rows: Sequence[Mapping[str, Any]], outputs: Sequence[str], title: str) -> Figure:
    """A dot where the part of a row moves the output of a column; rows have ``kind``, ``name`` and ``moves``."""
    size = (3.0 + 1.0 * len(outputs), 1.2 + 0.25 * len(rows))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=size, dpi=dots_within(size[1]), layout="constrained")
        axes = figure.subplots()
        for i, row in enumerate(rows):
            for k, output in enumerate(outputs):
                moved = row["moves"] is not None and output in row["moves"]
                axes.plot(k, i, "o", markersize=6 if moved else 2, color="C0" if moved else "0.75")
        axes.set_yticks(range(len(rows)), [f"{row['kind']} {row['name']}" for row in rows])
        axes.set_xticks(range(len(outputs)), list(outputs))
        axes.set_xlim(-0.5, max(len(outputs), 1) - 0.5)
        axes.invert_yaxis()
        axes.xaxis.tick_top()
        figure.suptitle(f"What moves the outputs of {title}", fontweight="bold")
    return figure
