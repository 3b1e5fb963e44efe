"""Dates such as 03/04/2026 in several files of an experiment: which number is the day is decided for all of them together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from greybox_torch.data.checks import DAY
from greybox_torch.data.readers.order_of_dates import days_of, is_date
from greybox_torch.data.readers.table import Table
from greybox_torch.data.readers.time_stamps import TimeStamps
from greybox_torch.errors import UserError


def of_one_order(tables: Sequence[Table], clock: str | None) -> tuple[tuple[Table, ...], tuple[str, ...]]:
    """The tables, and a note on what was concluded. Where one has a single date in the column ``clock``, so that its samples count from
    midnight, and others have further dates, it is read as theirs are, or as the dates of all files follow each other.

    Raises UserError where neither tells which number is the day.
    """
    orders = {} if clock is None else {k: one.dates[clock] for k, one in enumerate(tables) if clock in one.dates}
    untold = {k: order for k, order in orders.items() if order.untold}
    if clock is None or not untold or not (len({order.date for order in untold.values()}) > 1 or _dated(tables, clock)):
        return tuple(tables), ()
    together = TimeStamps(order.date for order in orders.values())
    told = {order.day_first for order in orders.values() if order.day_first is not None} or {together.day_first}
    day_first, first = told.pop(), min(untold)
    if told or day_first is None or not all(is_date(order.date, day_first=day_first) for order in untold.values()):
        raise UserError(
            f'{tables[first].path}, column "{clock}": found "{untold[first].date}", and other dates in other files: which number is the '
            "day cannot be told; expected dates like 2026-03-01, or an experiment for each file"
        )
    dated = list(tables)
    for k, order in untold.items():
        since = order.day * days_of(order.date, day_first=day_first)
        dated[k] = replace(dated[k], columns=dated[k].columns | {clock: dated[k].columns[clock] + since})
    order = "day before month" if day_first else "month before day"
    note = f'dates such as "{untold[first].date}" are read with the {order}, as those of the other files are or follow'
    return tuple(dated), (f'column "{clock}" of {tables[first].path.name}: {note}',)


def _dated(tables: Sequence[Table], clock: str) -> bool:
    """Whether a file has dates in the column of which it is known which they are."""
    return any(clock in table.stamps and (table.columns[clock] > DAY).any() for table in tables)
