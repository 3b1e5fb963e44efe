"""Single samples far away from their neighbours on both sides, as a logger writes -9999 where it has no value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data import DataSet, Recording
from greybox_torch.data.card import read_card
from greybox_torch.data.readers import read_table
from greybox_torch.data.source import source_of
from greybox_torch.errors import UserError

_RANGES, _SPREADS = 5.0, 200.0
"""How far away it is: in ranges of the channel, and in what a sample usually differs from the middle of its neighbours."""
_RANGES_OF_STEPS = 100.0
"""In ranges, where samples seldom differ from their neighbours: an input in steps, an encoder at rest."""
_WITHIN, _USUAL = 98.0, 95.0
"""Percent of the samples that a range and a usual difference are of, so that a few odd ones and their neighbours do not widen them."""


@dataclass(frozen=True)
class LoneSample:
    """The farthest of ``count`` such samples of a channel in an experiment; ``place`` is its line and column where a file has it."""

    experiment: str
    channel: str
    place: str
    value: float
    before: float
    after: float
    count: int

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        others = f" (and {self.count - 1} more such samples)" if self.count > 1 else ""
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": {self.place}: found {self.value:.6g} between '
            f"{self.before:.6g} and {self.after:.6g}{others}, as loggers write where a value is missing"
        )

    @property
    def write(self) -> str:
        """What to write instead."""
        return "an empty cell or NaN in its place, which is a missing sample, unless it was measured"

    def __str__(self) -> str:
        return f"{self.found}; expected {self.write}"


def lone_samples(data: DataSet) -> Iterator[LoneSample]:
    """Of every channel of every experiment the farthest such sample, if there is one."""
    for recording in data.recordings:
        for name, values in recording.signals.items():
            known = np.flatnonzero(~np.isnan(values))
            lone, distance = _lone(values[known])
            if lone.size:
                k = int(lone[np.argmax(distance)])
                here, before, after = (int(known[i]) for i in (k, k - 1, k + 1))
                place, column = _read_again(data, recording, name, here)
                shown = values if column is None else column
                yield LoneSample(
                    recording.name,
                    name,
                    place,
                    float(shown[here]),
                    float(shown[before]),
                    float(shown[after]),
                    len(lone),
                )


def _lone(values: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Indices of lone samples (K,) among values (N,), none of them missing, and how far away each is from its neighbours."""
    if len(values) < 10:
        return np.empty(0, dtype=np.intp), np.empty(0)
    left, right = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    low, high = np.percentile(values, [100.0 - _WITHIN, _WITHIN])
    usual = float(np.percentile(np.abs(left + right) / 2.0, _USUAL))
    least = max(_RANGES * (high - low), _SPREADS * usual) if usual > 0.0 else _RANGES_OF_STEPS * (high - low)
    nearer = np.where(left * right > 0.0, np.minimum(np.abs(left), np.abs(right)), 0.0)
    lone = np.flatnonzero(nearer > least) if high > low else np.empty(0, dtype=np.intp)
    return lone + 1, nearer[lone]


def _read_again(data: DataSet, recording: Recording, name: str, sample: int) -> tuple[str, NDArray[np.float64] | None]:
    """Where a sample stands, and the samples as the file has them; None where the channel is not a column of one."""
    place = f"sample {sample} (the first is 0)"
    if data.path is None or recording.source is None:
        return place, None
    card = read_card(data.path)
    said = {f"{entry.name}{end}": entry for entry in card.experiment for end in ("", " (held out)")}.get(recording.name)
    if said is None or card.decimate or card.resample or card.channels[name].derivative or len(said.file) > 1:
        return place, None
    columns = card.channels[name].expression(said.columns.get(name)).columns
    if len(columns) != 1:
        return place, None
    try:
        source = source_of([data.path.parent / said.file[0]], None, columns, None, read_table)
    except UserError:  # replaced meanwhile
        return place, None
    start, stop = recording.rows
    return source.place(columns[0], start + sample), source.columns[columns[0]][start:stop]
