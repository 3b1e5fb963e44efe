"""Counters of several turns that overflow: a channel jumps by 16 turns where its 16 bits count 4096 a turn."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greybox_torch.checking.as_in_the_file import as_in_the_file
from greybox_torch.data import DataSet, Recording
from greybox_torch.data.card_channels import ChannelEntry
from greybox_torch.data.unwrapping import several_turns_within, turn_within

_HALF = 0.5
"""Share of the range that a jump is more than; no other file is read again."""
_SAME = 1e-6
"""Share of the range by which a channel may differ from its column, but for a factor and an offset."""


@dataclass(frozen=True)
class Overflow:
    """``period`` in the channel's unit, ``jumps`` (K,) the samples before them among the known ones.

    ``counts`` is the period in the numbers of the file's column; None where they are not known.
    """

    period: float
    jumps: NDArray[np.intp]
    counts: float | None = None

    def call(self, entry: ChannelEntry) -> str:
        """What the channel is with the counter's overflows added up, where its ``counts`` are known."""
        (column,) = entry.expression().columns
        text = column if column.isidentifier() else f'col("{column}")'
        added = f"unwrap({text}, {self.counts:.0f})"
        if entry.expr is None:
            return added
        inside = re.escape(text) if not column.isidentifier() else rf"\b{re.escape(text)}\b"
        return re.sub(inside, lambda _: added, entry.expr)


def overflow_of(data: DataSet, recording: Recording, name: str) -> Overflow | None:
    """Of a channel that jumps by what its column of counts overflows after, or else by two, four, eight ... turns of its unit."""
    values = recording.measured(name)
    known = ~np.isnan(values)
    steps = np.abs(np.diff(values[known]))
    extent = float(np.ptp(values[known])) if len(steps) else 0.0
    if not extent or not np.isfinite(extent) or steps.max() <= _HALF * extent:
        return None
    _, column = as_in_the_file(data, recording, name, 0)
    if column is not None and not np.isnan(column[known]).any():
        counts = column[known]
        turn, jumps = turn_within(counts, "-")  # of whole numbers only
        factor = extent / float(np.ptp(counts)) if len(jumps) else 0.0
        factor *= float(np.sign(np.diff(values[known])[jumps[0]] * np.diff(counts)[jumps[0]])) if len(jumps) else 1.0
        apart = values[known] - values[known][0] - factor * (counts - counts[0])
        if len(jumps) and np.abs(apart).max() <= _SAME * extent:
            return Overflow(turn * abs(factor), jumps, turn)
    turn, jumps = several_turns_within(values[known], data.channels[name].unit)
    return Overflow(turn, jumps) if len(jumps) else None
