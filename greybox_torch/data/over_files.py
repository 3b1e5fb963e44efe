"""Positions of columns that count over several files, as if these stood side by side in one."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers.table import NoSuchColumn, Table

_POSITION = re.compile(r"#([1-9]\d{0,5})")


def over_files(files: Sequence[Path], join: str | None, read: Callable[..., Table]) -> Callable[..., Table]:
    """A ``read`` for files whose rows are joined: column "#3" is the first of the second file where the first one has two.

    Names often do not tell the columns of such files apart: seen were two of one column each, without a heading.
    """
    if join != "rows" or len(files) < 2:
        return read

    @cache
    def names(file: Path) -> tuple[str, ...]:
        return columns_of(file).names

    def reading(path: Path, columns: Sequence[str], marks: Sequence[tuple[str, str]] = ()) -> Table:
        own = {column: _own(column, path) for column in columns}
        wanted = tuple(dict.fromkeys(own.values()))
        of_file = tuple(sorted((own[column], mark) for column, mark in marks if column in own))
        table = read(path, wanted, of_file) if of_file else read(path, wanted)
        units = {column: table.units[name] for column, name in own.items() if name in table.units}
        return replace(table, columns={column: table.columns[name] for column, name in own.items()}, units=units)

    def _own(column: str, path: Path) -> str:
        """What the file itself calls a column."""
        position = _POSITION.fullmatch(column)
        if position is None:
            return column
        before = sum(len(names(file)) for file in files[: files.index(path)])
        there = int(position[1]) - before
        if not 1 <= there <= len(names(path)):
            found = ", ".join(f"{len(names(file))} in {file.name}" for file in files)
            raise NoSuchColumn(f'{files[0]}: no column "{column}"; found columns: {found}', column)
        return names(path)[there - 1]

    return reading
