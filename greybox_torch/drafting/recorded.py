"""What is in the files that a card is to be written for."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.checks import DAY
from greybox_torch.data.columns import columns_of
from greybox_torch.data.dates import are_dates, are_times_of_day
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.order_of_dates import OrderOfDates
from greybox_torch.data.readers.table import BadCell, Table
from greybox_torch.errors import UserError

_FEW = 5
"""Texts that stand among the numbers of a column, at most; a column with more of them is text."""
_MOST_LOST = 0.5
"""Share of samples that are missing, below which a column with such texts is one of numbers."""


@dataclass(frozen=True, eq=False)
class Recorded:
    """A file: columns (N,) of numbers by name, units by column where the file says them, single numbers by name.

    ``left_out`` are columns that hold another number of samples than most, ``faults`` those that hold something else than numbers,
    with what was found and where: here and there, those samples are missing in ``columns``; else they are not among them. ``marks`` has by
    column such texts as may stand for missing samples, which are no faults, and ``marked_at`` where the first of them is. ``stamps`` are
    columns of dates or times of day. ``lines`` has the line of every sample, where there are lines. ``dates`` has, by a column of times of
    day, the column of dates beside it, which were added to these times and is not among the columns. ``orders`` has by column what it
    tells of dates such as 03/04/2026.
    """

    path: Path
    columns: dict[str, NDArray[np.float64]]
    units: Mapping[str, str]
    numbers: Mapping[str, float]
    left_out: tuple[str, ...] = ()
    faults: Mapping[str, str] = field(default_factory=dict)
    marks: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    marked_at: Mapping[str, str] = field(default_factory=dict)
    stamps: frozenset[str] = frozenset()
    lines: Sequence[int] | None = None
    dates: Mapping[str, str] = field(default_factory=dict)
    orders: Mapping[str, OrderOfDates] = field(default_factory=dict)

    @property
    def samples(self) -> int:
        return len(next(iter(self.columns.values())))

    def where(self, sample: int) -> str:
        """Where a sample stands in the file."""
        return f"sample {sample} (the first is 0)" if self.lines is None else f"line {self.lines[sample]}"


def recorded(path: Path) -> Recorded:
    """All that can be read of a file. Raises UserError as the readers do, and where no column holds numbers."""
    listing = columns_of(path)
    table, odd = _read(path, listing.names)
    lengths = [len(values) for values in table.columns.values()]
    if not lengths and listing.names:
        read_table(path, listing.names[:1])  # says what is wrong with it
    if not lengths:
        raise UserError(f"{path}: found no column of numbers that could be read; expected a recording")
    usual = max(set(lengths), key=lambda n: (lengths.count(n), n))
    kept = {name: values for name, values in table.columns.items() if len(values) == usual}
    other = tuple(name for name in table.columns if name not in kept)
    pair = _dates_beside_times(kept, table.stamps)
    if pair is not None:
        time, date = pair
        kept = {name: values + kept[date] if name == time else values for name, values in kept.items() if name != date}
    return Recorded(
        path,
        kept,
        table.units,
        listing.numbers,
        other,
        odd.faults,
        odd.marks,
        odd.marked_at,
        table.stamps,
        table.lines,
        dict([pair] if pair else []),
        table.dates,
    )


def _dates_beside_times(columns: Mapping[str, NDArray[np.float64]], stamps: Collection[str]) -> tuple[str, str] | None:
    """The first column of times of day, and that of dates, of a file that has them in two columns."""
    written = {name: values for name, values in columns.items() if name in stamps}
    dates = [name for name, values in written.items() if are_dates(values) and np.nanmin(values) >= DAY]
    times = [name for name, values in written.items() if name not in dates and are_times_of_day(values)]
    return (times[0], dates[0]) if times and len(dates) == 1 else None


@dataclass(frozen=True)
class _Odd:
    """See :class:`Recorded`."""

    faults: dict[str, str] = field(default_factory=dict)
    marks: dict[str, tuple[str, ...]] = field(default_factory=dict)
    marked_at: dict[str, str] = field(default_factory=dict)


def _read(path: Path, names: Sequence[str]) -> tuple[Table, _Odd]:
    """All columns at once, or where one of them cannot be read, each that can; what is wrong with the others, and marks in them."""
    if not names:
        return Table(path, {}), _Odd()
    try:
        return read_table(path, names), _Odd()
    except UserError:
        pass
    columns: dict[str, NDArray[np.float64]] = {}
    units: dict[str, str] = {}
    stamps: frozenset[str] = frozenset()
    orders: dict[str, OrderOfDates] = {}
    lines, all_odd = None, _Odd()
    for name in names:
        one, odd = _column(path, name)
        marks = [e for e in odd if isinstance(e, BadCell) and e.mark and one is not None]
        if wrong := [e for e in odd if e not in marks]:
            all_odd.faults[name] = str(wrong[0]).removeprefix(f"{path}, ").replace(f', column "{name}"', "")
        if one is None:
            continue
        if marks:
            all_odd.marks[name] = tuple(e.cell for e in marks)
            all_odd.marked_at[name] = str(marks[0]).removeprefix(f"{path}, ").partition(", column")[0]
        columns |= one.columns
        units |= one.units
        stamps |= one.stamps
        orders |= one.dates
        lines = one.lines
    return Table(path, columns, lines, units, stamps=stamps, dates=orders), all_odd


def _column(path: Path, name: str) -> tuple[Table | None, list[UserError]]:
    """A column, and what is wrong with it; where a few texts stand among its numbers, as if these samples were missing."""
    odd: list[UserError] = []
    while True:
        cells = [(name, error.cell) for error in odd if isinstance(error, BadCell)]
        try:
            table = read_table(path, (name,), cells)
        except UserError as error:
            odd.append(error)
            if not isinstance(error, BadCell) or len(odd) > _FEW:
                return None, odd[:1]
            continue
        lost = np.isnan(table.columns[name]).mean() if odd else 0.0
        return (table, odd) if lost < _MOST_LOST else (None, odd[:1])
