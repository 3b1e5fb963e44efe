"""Dates in a column of their own, beside a column of times of day: together they are time stamps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.card_channels import TimeEntry
from greybox_torch.data.checks import DAY
from greybox_torch.data.readers.table import Table
from greybox_torch.errors import UserError

if TYPE_CHECKING:
    from greybox_torch.data.source import Read


def are_dates(values: NDArray[np.float64]) -> bool:
    """Whether seconds (N,) since 1970 are dates without a time of day."""
    known = values[~np.isnan(values)]
    return bool(len(known) and not (known % DAY).any())


def are_times_of_day(values: NDArray[np.float64]) -> bool:
    """Whether seconds (N,) are less than a day, but for a leap second."""
    known = values[~np.isnan(values)]
    return bool(len(known) and known.min() >= 0.0 and known.max() <= DAY)


def with_dates(read: Read, time: TimeEntry | None, clock: str | None) -> Read:
    """A ``read`` whose tables have the dates added to the column ``clock``, where the card names a column of dates.

    Raises UserError, when a table is read, for a column that holds no dates, and for times that have a date already.
    """
    date = None if time is None else time.date
    if time is None or date is None or clock is None:
        return read

    def reading(path: Path, columns: Sequence[str], marks: Sequence[tuple[str, str]] = ()) -> Table:
        more = (marks,) if marks else ()
        if clock not in columns:
            return read(path, columns, *more)
        table = read(path, tuple(dict.fromkeys((*columns, date))), *more)
        days, times = table.columns[date], table.columns[clock]
        if not are_dates(days):
            raise UserError(f'{path}, column "{date}": is no column of dates alone, such as 2026-03-01 or 01.03.2026')
        if not are_times_of_day(times * time.seconds):
            raise UserError(f'{path}, column "{clock}": is no column of times of day; expected time without date = "…"')
        kept = {name: values for name, values in table.columns.items() if name in columns}
        order = {clock: replace(table.dates[date], day=DAY / time.seconds)} if date in table.dates else {}
        return replace(table, columns=kept | {clock: times + days / time.seconds}, dates=order)

    return reading
