"""Files of equal length set side by side: sample k of one was taken with sample k of the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.checks import check_same_length
from greybox_torch.data.in_no_file import in_no_file
from greybox_torch.data.readers.table import NoSuchColumn, Table
from greybox_torch.errors import UserError


def joined_rows(
    files: Sequence[Path], columns: Sequence[str], time: str | None, read: Callable[..., Table]
) -> tuple[tuple[Table, ...], dict[str, NDArray[np.float64]]]:
    """The tables that have any of the columns, and each column (N,) from the one file that has it; time stamps from the first that does.

    Raises:
        UserError: as the readers do, where files differ in length, a column is in several of them or in none.
    """
    tables: list[Table] = []
    held: dict[str, NDArray[np.float64]] = {}
    lacking: dict[str, NoSuchColumn] = {}
    for file in files:
        table, absent = _what_there_is(file, columns, read)
        lacking |= absent
        if not table.columns:
            continue
        own = check_same_length(table.columns, table.path)
        _check_new([column for column in own if column in held and column != time], tables, table)
        tables.append(table)
        held = {**own, **held}
    for column in columns:
        if column not in held:
            raise in_no_file(files, column, str(lacking[column]) if column.startswith("#") else "")
    _check_lengths(tables)
    return tuple(tables), held


def _what_there_is(
    file: Path, columns: Sequence[str], read: Callable[..., Table]
) -> tuple[Table, dict[str, NoSuchColumn]]:
    wanted, absent = list(columns), {}
    while wanted:
        try:
            return read(file, tuple(wanted)), absent
        except NoSuchColumn as error:
            if error.column not in wanted:
                raise
            absent[error.column] = error
            wanted.remove(error.column)
    return Table(file, {}), absent


def _check_new(again: Sequence[str], before: Sequence[Table], table: Table) -> None:
    if again:
        first = next(one for one in before if again[0] in one.columns)
        raise UserError(
            f'{table.path}: column "{again[0]}" is in {first.path.name} as well; expected a name that one file alone has, or the '
            "position among the columns of all files, the first of the first being 1: column = 2"
        )


def _check_lengths(tables: Sequence[Table]) -> None:
    lengths = {table.path.name: len(next(iter(table.columns.values()))) for table in tables}
    if len(set(lengths.values())) > 1:
        found = ", ".join(f"{length} in {name}" for name, length in lengths.items())
        raise UserError(
            f'{tables[0].path}: join = "rows" sets samples of one number side by side, and found {found}; expected as many in each, or '
            'join = "time", which goes by time stamps'
        )
