"""The figure of a data set: every channel of every experiment over time."""

from __future__ import annotations

from textwrap import fill

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from greybox_torch.data import Channel, DataSet, Recording
from greybox_torch.data.own_samples import missing_samples
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

_MOST_COLUMNS = 3
_MOST_CHANNELS = 24


def plot_channels(data: DataSet, along: str = "") -> Figure:
    """An experiment a column, a channel a row; after three experiments the columns go on in another band of rows.

    The channels of an experiment share the time axis, since its start. A channel has the same vertical axis, in its unit,
    in all experiments. Of very many channels or experiments the figure shows the first, and says so. Gaps in the time stamps break the
    curve; samples that stand alone are dots. Missing samples leave a gap in it and a red mark at the foot of it, and are counted beside the
    axes.

    Args:
        along: the label of the horizontal axis, where it is no time.
    """
    channels = list(data.channels.values())[:_MOST_CHANNELS]
    recordings = data.recordings[: max(MOST_PANELS // len(channels), 1)]
    unit = time_unit(0.0 if along else max(recording.seconds for recording in recordings))
    columns = min(len(recordings), _MOST_COLUMNS)
    bands = -(-len(recordings) // columns)
    size = (max(8.0, 4.5 * columns), 0.8 + bands * (0.6 + 1.8 * len(channels)))
    dots_per_inch = dots_within(size[1])
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=size, dpi=dots_per_inch, layout="constrained")
        left_out = shown_of("channels", len(channels), len(data.channels)) + shown_of(
            "experiments", len(recordings), len(data.recordings)
        )
        figure.suptitle(data.name + left_out, fontweight="bold")
        grid = figure.add_gridspec(bands * len(channels), columns)
        same_channel: dict[str, Axes] = {}
        for index, recording in enumerate(recordings):
            band, column = divmod(index, columns)
            top = None
            for row, channel in enumerate(channels):
                axes = figure.add_subplot(
                    grid[band * len(channels) + row, column], sharex=top, sharey=same_channel.get(channel.name)
                )
                same_channel.setdefault(channel.name, axes)
                top = top or axes
                _plot(axes, recording, channel, unit.seconds)
                axes.tick_params(labelbottom=row == len(channels) - 1, labelleft=column == 0)
                if column == 0:
                    axes.set_ylabel(with_unit(channel.name, channel.unit))
            if top is not None:
                top.set_title(f"{fill(recording.name, 40)} ({recording.role})", fontsize=10)
            axes.set_xlabel(along or unit.label)
    return figure


def _plot(axes: Axes, recording: Recording, channel: Channel, seconds: float) -> None:
    """``seconds`` is one unit of the time axis."""
    values, time = recording.signals[channel.name], since_start(recording) / seconds
    plot_samples(axes, time, values, linewidth=0.7)
    axes.margins(x=0)
    missing = time[missing_samples(recording, channel.name)]
    if missing.size:
        foot = axes.get_xaxis_transform()
        axes.plot(missing, np.zeros_like(missing), "|", color="tab:red", markersize=8, transform=foot)
        axes.text(  # outside: inside it lies on the curve
            1.01, 0.5, f"{missing.size} missing", color="tab:red", rotation=90, va="center", transform=axes.transAxes
        )
