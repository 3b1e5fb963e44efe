"""What is said of a column that none of several files of an experiment has: the nearest name, and the columns that there are."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers.table import NoSuchColumn, named
from greybox_torch.errors import UserError, did_you_mean


def in_no_file(files: Sequence[Path], column: str, said: str = "") -> NoSuchColumn:
    """The error to raise. ``said`` is its beginning where more is known of a column than that it is not there."""
    there: dict[Path, tuple[str, ...]] = {}
    for file in files:
        with suppress(UserError):  # a format that cannot list its columns
            there[file] = columns_of(file).names
    hint = did_you_mean(column, [name for names in there.values() for name in names[:2000]])
    listed = "; ".join(f"{named(names)} in {file.name}" for file, names in there.items())
    begin = said or f'{files[0]}: no column "{column}"{hint}'
    names = ", ".join(file.name for file in files)
    return NoSuchColumn(
        f"{begin}; it is in none of {names}{f'; found {listed}' if listed and not said else ''}", column
    )
