"""Error codes such as -9999, and single samples far away from both neighbours: what loggers write where they have no value."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greybox_torch.checking.as_in_the_file import as_in_the_file
from greybox_torch.checking.error_codes import far_off, is_error_code
from greybox_torch.checking.joined_files import JoinedFiles
from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.readers.table import Table

_ODD = 0.05
"""Share of the samples at either end that the range leaves out, so that the error values themselves do not widen it."""
_RANGES = 5.0
"""Ranges of the channel that one lies off at least: what a machine does in one sample stays near the range it moves in, and error values
are the largest number of a format, or one that nobody would measure."""
_SPREADS = 600.0
"""And what a sample usually differs from the middle of its neighbours, the median: about 500 standard deviations of noise. A blow in a
channel that rests otherwise leaves its range far behind, but is seldom that far above the noise."""
_RANGES_OF_STEPS = 100.0
"""In ranges, where most samples lie between their neighbours exactly and there is no noise to measure with: an encoder at rest may flicker,
an input in steps may have a single pulse. -9999 is that far away wherever a channel moves within less than 100 units."""
_SMOOTH = 0.1
"""Share of its range up to which a channel moves in one sample where it is smooth, as a position is (both without the samples in doubt)."""
_RANGES_OF_SMOOTH = 1.5
"""In such ranges: what is smooth elsewhere does not go that far and come back at once, in 15 times its fastest step at least. Seen: an
angle of 360° where a knee moves within 123°, 5000 rpm where a pump runs with up to 2740."""


@dataclass(frozen=True)
class LoneSample(InASentence):
    """One of ``count`` such samples of a channel in an experiment; ``place`` is its line and column where a file has it,
    ``on_card`` whether the values are those of the file, as a card would name them. ``before`` and ``after`` are the nearest other samples,
    None where it begins or ends the recording.
    """

    experiment: str
    channel: str
    place: str
    value: float
    before: float | None
    after: float | None
    count: int
    on_card: bool = False

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        others = f" (and {self.count - 1} more such sample{'s' * (self.count > 2)})" if self.count > 1 else ""
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": {self.place}: found {self.value:.6g} {self._among}'
            f"{others}, as loggers write where a value is missing"
        )

    @property
    def _among(self) -> str:
        if self.before is not None and self.after is not None:
            return f"between {self.before:.6g} and {self.after:.6g}"
        return f"before {self.after:.6g}" if self.before is None else f"behind {self.before:.6g}"

    @property
    def write(self) -> str:
        """What to write instead."""
        marked = f" (or missing = {self.value:.12g} in the channel's line on the card)" if self.on_card else ""
        return f"an empty cell or NaN in its place, which is a missing sample{marked}, unless it was measured"


def lone_samples(data: DataSet, joined: Mapping[str, JoinedFiles]) -> Iterator[LoneSample]:
    """Of every channel of every experiment the first sample with an error code, or else the farthest lone one, if there is one.

    Args:
        joined: by recording.
    """
    for recording in data.recordings:
        for name in recording.signals:
            # the samples of a slower file or column: in between, straight lines spread an error value over several
            files = joined.get(recording.name)
            own = None if files is None else _of_joined(files, name)
            values = recording.measured(name) if own is None else own.values
            known = np.flatnonzero(~np.isnan(values))
            lone, distance = _lone(values[known])
            doubted = [(known[at], True) for at in far_off(values[known])]
            doubted += [(known[lone[np.argsort(-distance, kind="stable")]], False)] if lone.size else []
            for at, if_code in doubted:
                here = int(at[0])
                place, column = (own.place(here), None) if own else as_in_the_file(data, recording, name, here)
                shown = values if column is None else column
                if if_code and not is_error_code(float(shown[here])):
                    continue
                others = known[values[known] != values[here]]
                before, after = others[others < here][-1:], others[others > here][:1]
                yield LoneSample(
                    recording.name,
                    name,
                    place,
                    float(shown[here]),
                    float(shown[before[0]]) if before.size else None,
                    float(shown[after[0]]) if after.size else None,
                    len(at),
                    own is not None or column is not None,
                )
                break


@dataclass(frozen=True, eq=False)
class _OfJoined:
    """A column of a joined file, as far as the recording reaches: its samples from ``first`` on."""

    table: Table
    column: str
    first: int
    count: int

    @property
    def values(self) -> NDArray[np.float64]:
        return self.table.columns[self.column][self.first : self.first + self.count]

    def place(self, sample: int) -> str:
        return self.table.place(self.column, self.first + sample)


def _of_joined(files: JoinedFiles, channel: str) -> _OfJoined | None:
    found = files.of(channel)
    if found is None:
        return None
    first, stamps = files.stamps(found[0])
    return _OfJoined(*found, first, len(stamps))


def _lone(values: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Indices of lone samples (K,) among values (N,), none of them missing, and how far away each is from its neighbours."""
    if len(values) < 10:
        return np.empty(0, dtype=np.intp), np.empty(0)
    left, right = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    cut = math.ceil(_ODD * len(values))
    low, high = np.sort(values)[[cut, -1 - cut]]
    usual = float(np.median(np.abs(left + right))) / 2.0  # every lone sample spoils three of them, a percentile soon
    least = max(_RANGES * (high - low), _SPREADS * usual) if usual > 0.0 else _RANGES_OF_STEPS * (high - low)
    nearer = np.where(left * right > 0.0, np.minimum(np.abs(left), np.abs(right)), 0.0)
    least = min(least, _least_where_smooth(values, nearer > high - low))
    lone = np.flatnonzero(nearer > least) if high > low else np.empty(0, dtype=np.intp)
    return lone + 1, nearer[lone]


def _least_where_smooth(values: NDArray[np.float64], doubted: NDArray[np.bool_]) -> float:
    """From how far away one is lone among values (N,) that are smooth without those ``doubted`` (N - 2,); infinite where they are not."""
    rest = np.delete(values, np.flatnonzero(doubted) + 1)
    extent = float(np.ptp(rest))
    smooth = 0.0 < float(np.abs(np.diff(rest)).max()) <= _SMOOTH * extent
    return _RANGES_OF_SMOOTH * extent if smooth else math.inf
