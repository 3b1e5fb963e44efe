"""The files that were joined in time to the first one of an experiment, as they stand: what a join hides is looked for in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data import DataSet, Recording
from greybox_torch.data.card import TIME, Card, card_at
from greybox_torch.data.card_channels import ExperimentEntry
from greybox_torch.data.error_values import without_error_values
from greybox_torch.data.file_clocks import with_clocks
from greybox_torch.data.gaps import Gap, gap_steps
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.table import Table
from greybox_torch.data.source import Read, Source, source_of
from greybox_torch.errors import UserError


@dataclass(frozen=True, eq=False)
class JoinedFiles:
    """Of one recording. ``rows`` are the experiment's in the first file, ``columns`` those of channels that are one column, ``clock`` is
    the column of time stamps, a unit of which is so many ``seconds``; ``names`` are those of all files on the card.
    """

    recording: Recording
    source: Source
    rows: tuple[int, int]
    columns: Mapping[str, str]
    clock: str
    seconds: float
    names: tuple[str, ...]

    @property
    def time(self) -> NDArray[np.float64]:
        """Time stamps of the whole first file, in s."""
        return self.source.columns[self.clock] * self.seconds

    def stamps(self, table: Table) -> tuple[int, NDArray[np.float64]]:
        """Time stamps of a joined file, in s, as far as the recording reaches, and which sample of that file the first of them is."""
        stamps = table.columns[self.clock] * self.seconds
        begin = max(int(np.searchsorted(stamps, self.recording.time[0], side="right")) - 1, 0)
        end = int(np.searchsorted(stamps, self.recording.time[-1], side="left")) + 1
        return begin, stamps[begin:end]

    def longest_gap(self, table: Table, until: float) -> Gap | None:
        """The longest gap of a joined file in which samples of the experiment are missing, the first of them in this recording, which the
        experiment's next part follows at ``until`` (s). ``after`` is a sample of that file; the gap is told as far as the experiment goes.

        What is a gap is judged on the whole file, as joining it does: a part of it may have another usual step.
        """
        stamps, time, own = table.columns[self.clock] * self.seconds, self.time[slice(*self.rows)], self.recording.time
        steps = np.flatnonzero(gap_steps(table.columns[self.clock]))
        begins, ends = np.maximum(stamps[steps], time[0]), np.minimum(stamps[steps + 1], time[-1])
        lost = np.searchsorted(time, stamps[steps], side="right")  # the first sample in each, if one is
        first = time[np.minimum(lost, len(time) - 1)]
        here = (lost < len(time)) & (first < stamps[steps + 1]) & (first >= own[0]) & (first < until)
        if not here.any():
            return None
        k = int(np.argmax(np.where(here, ends - begins, -np.inf)))
        step = float(np.median(np.diff(stamps)))
        return Gap(int(steps[k]), float(begins[k]), float(ends[k]), step, int(here.sum()), float(own[0]))

    def name_of(self, table: Table) -> str:
        """What the card calls the file of a joined table."""
        return self.names[1 + self.source.joined.index(table)]

    def of(self, channel: str) -> tuple[Table, str] | None:
        """The joined file that a channel is one column of, and the column."""
        column = self.columns.get(channel)
        return next(((t, column) for t in self.source.joined if column is not None and column in t.columns), None)


def joined_files(data: DataSet) -> dict[str, JoinedFiles]:
    """By the recording's name; without those whose card or files were replaced meanwhile."""
    try:
        card = card_at(data.path)
    except UserError:
        card = None
    if card is None:
        return {}
    read, found = cache(read_table), {}
    for entry in card.experiment:
        if entry.join == "time" and len(entry.file) > 1:
            for recording in data.recordings:
                if recording.name in (entry.name, f"{entry.name}{HELD_OUT}"):
                    try:
                        found[recording.name] = _read_again(data, card, entry, recording, read)
                    except (UserError, KeyError):
                        continue
    return found


def _read_again(data: DataSet, card: Card, entry: ExperimentEntry, recording: Recording, read: Read) -> JoinedFiles:
    if data.path is None or card.time is None or set(card.channels) != set(recording.signals):
        raise KeyError(TIME)
    card = card.of(entry)
    assert card.time is not None
    clock = card.time.column
    formulas = card.formulas(entry)
    columns = {name: formula.columns for name, formula in formulas.items()}
    needed = dict.fromkeys([*(column for of in columns.values() for column in of), clock])
    files = [data.path.parent / file for file in entry.file]
    known = without_error_values(with_clocks(files, entry, card.time, read), card.channels, formulas)
    source = source_of(files, entry.join, list(needed), clock, known)
    start, stop = entry.rows or (0, len(source.columns[clock]))
    alone = {name: of[0] for name, of in columns.items() if len(of) == 1}
    return JoinedFiles(recording, source, (start, stop), alone, clock, card.time.seconds, tuple(entry.file))
