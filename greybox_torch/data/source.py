"""The columns of one experiment, from one file or from several that belong together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.checks import check_finite, check_same_length, check_time
from greybox_torch.data.clocks_written import in_clocks
from greybox_torch.data.gaps import in_gaps, lost_samples
from greybox_torch.data.in_no_file import in_nested_file, in_no_file
from greybox_torch.data.joined_rows import joined_rows
from greybox_torch.data.one_order import of_one_order
from greybox_torch.data.processing import at_times, between_samples
from greybox_torch.data.readers.table import NoSuchColumn, Table
from greybox_torch.data.unwrapping import unwrapped
from greybox_torch.errors import UserError

Read = Callable[..., Table]

JOINED_IN_TIME = "joined in time"
"""In notes, of a column that is from another file than the time stamps."""

_SHOWN = 3
"""Places at which samples are missing in a joined file."""


@dataclass(frozen=True, eq=False)
class Source:
    """Columns (N,) as they stand in the tables, which follow each other; `notes` say what was done to join them.

    `joined` are the tables, with time stamps of their own, whose columns were brought to the times of the first; `beside` those whose
    samples stand beside those of the first. `between`, by column, marks the samples that lie between those of a slower file.
    """

    tables: tuple[Table, ...]
    columns: dict[str, NDArray[np.float64]]
    notes: tuple[str, ...] = ()
    joined: tuple[Table, ...] = ()
    beside: tuple[Table, ...] = ()
    between: dict[str, NDArray[np.bool_]] = field(default_factory=dict)

    def place(self, column: str, sample: int) -> str:
        """Where a sample stands, to begin a message with."""
        if self.beside:
            return self.table(column).place(column, sample)
        for table in self.tables[:-1]:
            length = len(next(iter(table.columns.values())))
            if sample < length:
                return table.place(column, sample)
            sample -= length
        return self.tables[-1].place(column, sample)

    def table(self, column: str) -> Table:
        """The first one that has a column."""
        return next((table for table in self.every if column in table.columns), self.tables[0])

    @property
    def every(self) -> tuple[Table, ...]:
        """All tables, of whatever join."""
        return (*self.tables, *self.joined, *self.beside)


def source_of(
    files: Sequence[Path],
    join: str | None,
    columns: Sequence[str],
    time: str | None,
    read: Read,
    turns: Mapping[str, float] = MappingProxyType({}),
) -> Source:
    """The columns from the files.

    Args:
        join: "concatenate", "time" or "rows" where there are several.
        time: the column of time stamps; None where samples are even.
        turns: columns whose turns are to be added up before files are joined in time, and a turn of each: straight lines between the
            samples of a slower file would cross the jump.

    Raises:
        UserError: as the readers do; columns of different length; files to be joined in time where there are no time stamps; files of
            different length whose rows are to be joined.
    """
    if len(files) == 1:
        try:
            table = read(files[0], tuple(columns))
        except NoSuchColumn as error:
            raise in_nested_file(files[0], error) from None
        return Source((table,), check_same_length(table.columns, table.path), table.notes)
    if join == "concatenate":
        tables, note = of_one_order([read(file, tuple(columns)) for file in files], time)
        held = [check_same_length(table.columns, table.path) for table in tables]
        joined = {column: np.concatenate([one[column] for one in held]) for column in columns}
        return Source(
            tables, joined, tuple(dict.fromkeys([*(note for table in tables for note in table.notes), *note]))
        )
    if join == "rows":
        tables, held = joined_rows(files, columns, time, read)
        notes = tuple(dict.fromkeys(note for table in tables for note in table.notes))
        return Source(tables[:1], held, notes, beside=tables[1:])
    if time is None:
        raise UserError(
            f'{files[0]}: join = "time" needs time stamps; expected time = "<column>" at the top of the card, or, for files whose samples '
            'were taken together, join = "rows"'
        )
    return _joined_in_time(files, columns, time, read, turns)


def _joined_in_time(
    files: Sequence[Path], columns: Sequence[str], time: str, read: Read, turns: Mapping[str, float]
) -> Source:
    """Every column from the first file that has it, at the time stamps of the first file; missing where its own file has a gap."""
    lacking, read_one, held, between = [c for c in columns if c != time], [], {}, {}
    for file in files:
        read_one.append(_what_there_is(file, lacking, time, read))
        lacking = [column for column in lacking if column not in read_one[-1].columns]
    tables, told = of_one_order(read_one, time)
    notes = list(told)
    for file, table in zip(files, tables, strict=True):
        own = check_same_length(table.columns, table.path)
        notes += table.notes
        if not len(own[time]) and table is not tables[0]:
            raise UserError(f"{file}: has no samples; expected lines of numbers below its header")
        check_time(own[time], lambda sample, table=table: table.place(time, sample))
        if table is tables[0]:
            held = own
        else:
            unknown = in_gaps(held[time], own[time])
            across = ", and missing across its gaps" if unknown.any() else ""
            across = f"{_also_across_lost(table, own[time])}{across}"
            of_none = between_samples(held[time], own[time])
            for column in own:
                if column != time:
                    check_finite(own[column], lambda sample, table=table, column=column: table.place(column, sample))
                    values = unwrapped(own[column], turns[column]) if column in turns else own[column]
                    held[column] = np.where(unknown, np.nan, at_times(held[time], own[time], values))
                    notes.append(
                        f'column "{column}" is from {file.name}, {JOINED_IN_TIME} on straight lines between its samples{across}'
                    )
                    between |= {} if of_none is None else {column: of_none}
    if lacking:
        raise in_no_file(files, lacking[0])
    return Source(tables[:1], held, tuple(notes), tables[1:], between=between)


def _also_across_lost(table: Table, stamps: NDArray[np.float64]) -> str:
    """That straight lines lie across single samples which a file with these time stamps lacks, to go on with."""
    lost = lost_samples(stamps)
    if not lost:
        return ""
    count, more = sum(one.count for one in lost), ", …" * (len(lost) > _SHOWN)
    at = "sample" if table.lines is None else "line"
    where = [str(one.after if table.lines is None else table.lines[one.after]) for one in lost[:_SHOWN]]
    samples = "1 sample that is" if count == 1 else f"{count} samples that are"
    return f", also across {samples} missing there (after {at}{'s' * (len(lost) > 1)} {', '.join(where)}{more})"


def _what_there_is(file: Path, columns: Sequence[str], time: str, read: Read) -> Table:
    wanted = [*columns, time]
    while True:
        try:
            return read(file, tuple(wanted))
        except NoSuchColumn as error:
            if error.column == time:
                said = (
                    f"{error}; files that are joined in time have their time stamps in a column of one name; else give this file's: "
                    f"{in_clocks(file.name, column='…')}; or its position, where that is one in all of them: time = 1 for the first "
                    "column of each"
                )
                raise NoSuchColumn(said, time) from None
            if error.column not in wanted:
                raise
            wanted.remove(error.column)
