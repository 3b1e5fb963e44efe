"""What is said of a column that no file of an experiment has: the nearest name, and the columns that there are."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers.table import NoSuchColumn, named
from greybox_torch.errors import UserError, did_you_mean

_NESTED = (".mat", ".h5", ".hdf5", ".npz", ".json")
"""Formats whose columns may stand inside of others; readers name the outer ones alone."""


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


def in_nested_file(file: Path, error: NoSuchColumn) -> NoSuchColumn:
    """The error of a reader, with the columns inside of the structures of the file in the place of these alone; itself of other files."""
    with suppress(UserError):
        names = columns_of(file).names
        if file.suffix.lower() in _NESTED and str(error).startswith(f'{file}: no column "{error.column}"'):
            hint = did_you_mean(error.column, names[:2000])
            return NoSuchColumn(f'{file}: no column "{error.column}"{hint}; found {named(names)}', error.column)
    return error
