"""Times over samples on logarithmic axes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from experiments.speed.row import Row
from greybox_torch.files import replacing

COLOURS = ("#0b6e99", "#c8553d", "#6a7f3f")


def draw_growth(row: Row, file: Path) -> None:
    """Every curve of ``row`` (samples, seconds) with its power law beside it, as a PNG."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.add_subplot()
    for colour, (name, curve) in zip(COLOURS, row.curves.items(), strict=False):
        samples, seconds = np.array(curve).T
        label = name
        if len(curve) > 1:
            label += f", slope {np.polyfit(np.log(samples), np.log(seconds), 1)[0]:.2f}"
        axes.loglog(samples, seconds, "o-", color=colour, linewidth=1.8, markersize=6, label=label)
    axes.legend(loc="upper left", frameon=False)
    axes.set_xlabel("samples of the record")
    axes.set_ylabel("time of one pass in s")
    axes.set_title("Free run of the arm with 12 forward sensitivities", loc="left", fontsize=11)
    axes.grid(which="major", color="#d9d9d9", linewidth=0.8)
    axes.grid(which="minor", color="#f0f0f0", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    with replacing(file) as temporary:
        figure.savefig(temporary, dpi=160)
