"""Readers of recordings, one file a format.

A reader is a function `(path, columns) -> Table` that reads the named columns of a file as float64, with NaN for
missing samples, and raises UserError for a file that it cannot read, a column that is not there, or one that does not
hold numbers. A format that comes with the package is a file of its own and a line in `READERS`; one from elsewhere is
entered by `register_reader`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path

from greybox_torch.data.readers.csv import read_csv
from greybox_torch.data.readers.matlab import read_matlab
from greybox_torch.data.readers.npz import read_npz
from greybox_torch.data.readers.parquet import read_parquet
from greybox_torch.data.readers.table import Table
from greybox_torch.errors import UserError, did_you_mean

Reader = Callable[[Path, Collection[str]], Table]

READERS: dict[str, Reader] = {
    ".csv": read_csv,
    ".mat": read_matlab,
    ".npz": read_npz,
    ".parquet": read_parquet,
}


BUILT_IN = frozenset(READERS)


def register_reader(suffix: str, reader: Reader) -> Reader:
    """Let cards name files that end in ``suffix`` (such as ".tdms"), to be read by ``reader``.

    Raises:
        UserError: ``suffix`` does not begin with a dot, has a reader that came with the package, or ``reader`` cannot be called.
    """
    if not (isinstance(suffix, str) and suffix.startswith(".") and len(suffix) > 1 and suffix == suffix.lower()):
        raise UserError(
            f'register_reader: suffix is {suffix!r}; expected a dot and lower-case letters, such as ".tdms"'
        )
    if suffix in BUILT_IN:
        raise UserError(
            f'register_reader: files ending in "{suffix}" have a reader already; expected none of {", ".join(BUILT_IN)}'
        )
    if not callable(reader):
        raise UserError(f"register_reader: reader is {reader!r}; expected a function (path, columns) -> Table")
    READERS[suffix] = reader
    return reader


def unregister_reader(suffix: str) -> None:
    """Take a reader of one's own out again. Raises UserError where there is none for ``suffix``, or where it came with the package."""
    if suffix in BUILT_IN or suffix not in READERS:
        own = ", ".join(s for s in READERS if s not in BUILT_IN) or "none"
        raise UserError(f'unregister_reader: "{suffix}" was not registered; registered are: {own}')
    del READERS[suffix]


def read_table(path: Path, columns: Collection[str]) -> Table:
    """The named columns of the file at `path`, by the reader for its suffix. Raises UserError as the readers do."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise UserError(f'{path}: no reader for files ending in "{path.suffix}"; expected one of {", ".join(READERS)}')
    if path.is_dir():
        raise UserError(f"{path}: is a folder; expected a recording")
    if not path.exists():
        beside = [other.name for other in path.parent.iterdir()] if path.parent.is_dir() else []
        hint = did_you_mean(path.name, beside)
        raise UserError(f"{path}: no such file{hint}; expected a recording, named relative to the data card")
    try:
        return reader(path, columns)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror or error}") from None
