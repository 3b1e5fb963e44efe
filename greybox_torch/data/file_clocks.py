"""The time stamps of each file as the one column that the card names, in its unit: what a file calls them, their dates and their zero."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from greybox_torch.data.card_channels import ExperimentEntry, FileClock, TimeEntry
from greybox_torch.data.clocks_written import in_clocks
from greybox_torch.data.dates import are_times_of_day, with_dates
from greybox_torch.data.over_files import over_files
from greybox_torch.data.readers.table import NoSuchColumn, Table
from greybox_torch.data.time_units import unit_of_time
from greybox_torch.errors import UserError

Reading = Callable[..., Table]


def with_clocks(files: Sequence[Path], experiment: ExperimentEntry, time: TimeEntry | None, read: Reading) -> Reading:
    """A ``read`` for the files of an experiment, with the dates of their time stamps, and with those of each file of `clocks` as the column
    of ``time``.

    Args:
        files: where those that the experiment names are.
        time: as the card says it of this experiment; None where samples are even.

    Raises:
        UserError: from what it returns, as the readers and :func:`with_dates` do, and where a file says another unit than its clock.
    """
    of_rows = over_files(files, experiment.join, read)
    if time is None:
        return of_rows
    own = experiment.columns.get("time")
    usual = _dated(of_rows, time, of_card=own is not None and own.date is None)
    clocks = {
        path: _own(of_rows, path, name, experiment.clocks[name], time, usual)
        for path, name in zip(files, experiment.file, strict=True)
        if name in experiment.clocks
    }

    def reading(path: Path, columns: Sequence[str], marks: Sequence[tuple[str, str]] = ()) -> Table:
        return clocks.get(path, usual)(path, columns, *((marks,) if marks else ()))

    return reading


def _dated(read: Reading, time: TimeEntry, *, of_card: bool) -> Reading:
    """With dates. Where these are of the card (``of_card``), and the experiment has a column of its own, they are those of files that have
    them and times of day beside them; other files have whole time stamps.
    """
    dated = with_dates(read, time, time.column)
    if time.date is None or not of_card:
        return dated

    def reading(path: Path, columns: Sequence[str], marks: Sequence[tuple[str, str]] = ()) -> Table:
        more = (marks,) if marks else ()
        if time.column not in columns:
            return read(path, columns, *more)
        try:
            table = read(path, tuple(dict.fromkeys((*columns, str(time.date)))), *more)
        except NoSuchColumn as error:
            if error.column != time.date:
                raise
            return read(path, columns, *more)
        whole = not are_times_of_day(table.columns[time.column] * time.seconds)
        return (read if whole else dated)(path, columns, *more)

    return reading


def _own(read: Reading, file: Path, name: str, clock: FileClock, time: TimeEntry, usual: Reading) -> Reading:
    """Of the file that the experiment calls ``name``."""
    given = clock.model_dump(include={"column", "unit", "date"}, exclude_none=True)
    kept = time.model_dump(exclude_none=True, exclude={"date"} if clock.column else None)
    own = TimeEntry.model_validate(kept | given)
    dated = with_dates(read, own, own.column) if clock.column or clock.date else usual

    def reading(path: Path, columns: Sequence[str], marks: Sequence[tuple[str, str]] = ()) -> Table:
        more = (marks,) if marks else ()
        if time.column not in columns:
            return read(path, columns, *more)
        wanted = tuple(dict.fromkeys(own.column if column == time.column else column for column in columns))
        table = dated(path, wanted, *more)
        _check_unit(table, name, own)
        factor = own.seconds / time.seconds
        stamps = table.columns[own.column] * factor + clock.offset / time.seconds
        held = {column: stamps if column == time.column else table.columns[column] for column in columns}
        orders = {time.column if column == own.column else column: order for column, order in table.dates.items()}
        if time.column in orders:
            orders[time.column] = replace(orders[time.column], day=orders[time.column].day * factor)
        return replace(
            table,
            columns=held,
            units={column: unit for column, unit in table.units.items() if column in held and column != time.column},
            stamps=frozenset(time.column if column == own.column else column for column in table.stamps),
            dates=orders,
        )

    return reading


def _check_unit(table: Table, name: str, own: TimeEntry) -> None:
    said = table.units.get(own.column, "")
    found = unit_of_time(said)
    if found and found != own.unit.replace("µ", "u"):
        write = in_clocks(name, column=own.column, unit=found)
        raise UserError(
            f'{table.path} has column "{own.column}" in "{said}", the card says "{own.unit}"; expected {write}'
        )
