"""Readers of recordings, one file a format.

A reader is a function `(path, columns) -> Table` that reads the named columns of a file as float64, with NaN for
missing samples, and raises UserError for a file that it cannot read, a column that is not there, or one that does not
hold numbers. A format that comes with the package is a file of its own and a line in `READERS`; one from elsewhere is
entered by `register_reader`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import TypeVar

from greybox_torch.data.readers.csv import read_csv
from greybox_torch.data.readers.hdf5 import read_hdf5
from greybox_torch.data.readers.json_log import read_json, read_json_lines
from greybox_torch.data.readers.matlab import read_matlab
from greybox_torch.data.readers.mcap_log import read_mcap
from greybox_torch.data.readers.npz import read_npz
from greybox_torch.data.readers.parquet import read_parquet
from greybox_torch.data.readers.ros_bag import read_ros_bag
from greybox_torch.data.readers.table import Table
from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.reading import check_file

Reader = Callable[[Path, Collection[str]], Table]
_Found = TypeVar("_Found")

READERS: dict[str, Reader] = {
    ".csv": read_csv,
    ".mat": read_matlab,
    ".npz": read_npz,
    ".parquet": read_parquet,
    ".h5": read_hdf5,
    ".hdf5": read_hdf5,
    ".json": read_json,
    ".jsonl": read_json_lines,
    ".ndjson": read_json_lines,
    ".mcap": read_mcap,
    ".db3": read_ros_bag,
    ".tsv": read_csv,
    ".txt": read_csv,
    ".dat": read_csv,
    ".asc": read_csv,
    ".lvm": read_csv,
}


BUILT_IN = frozenset(READERS)

WORKBOOKS, SAVE_AS_CSV = (".xlsx", ".xlsm", ".xls", ".ods"), "save the sheet as CSV"
"""What spreadsheets write, and what to do about it."""

_FIRST_BYTES = {b"PK\x03\x04": "an Excel file, or another ZIP archive", b"\xd0\xcf\x11\xe0": "an old Excel file"}


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


def read_table(path: Path, columns: Collection[str], marks: Collection[tuple[str, str]] = ()) -> Table:
    """The named columns of the file at `path`, by the reader for its suffix.

    Args:
        marks: pairs of a column and a text that is a missing sample in it; of files of text alone, since others have missing numbers.

    Raises UserError as the readers do, and for whatever else the library behind a reader raises: a damaged file has ways of its own.
    """
    of_text = marks and READERS.get(path.suffix.lower()) is read_csv
    return guarded(path, READERS)(path, columns, *((marks,) if of_text else ()))


def guarded(path: Path, table: Mapping[str, Callable[..., _Found]]) -> Callable[..., _Found]:
    """The function of `table` for the suffix of `path`; whatever it raises becomes a UserError, and no library says anything.

    Raises UserError where there is no such file, or no function for its suffix.
    """
    if "\0" in str(path):
        raise UserError(
            f"{ascii(str(path))[1:-1]}: cannot be the name of a file: embedded null byte; expected a recording"
        )
    suffix = path.suffix.lower()
    if suffix not in table and path.is_dir():
        raise UserError(f"{path}: is a folder; expected a recording in it")
    if suffix not in table:
        hint = f"; {SAVE_AS_CSV}" if suffix in WORKBOOKS else ""
        raise UserError(
            f'{path}: no reader for files ending in "{path.suffix}"; expected one of {", ".join(table)}{hint}'
        )
    _check_there(path)
    _check_not_empty(path)
    _check_no_workbook(path, suffix)

    def call(*arguments: object) -> _Found:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a library's remark on a file is of no use beside our own message
                return table[suffix](*arguments)
        except UserError:
            raise
        except MemoryError:
            raise UserError(f"{path}: needs more memory than there is; expected a smaller recording") from None
        except OSError as error:
            raise UserError(f"{path}: cannot be read: {_said(error)}") from None
        except Exception as error:
            raise UserError(
                f"{path}: cannot be read as {suffix}: {type(error).__name__}: {_said(error)}; "
                "the file is damaged, or of another kind"
            ) from None

    return call


def _check_there(path: Path) -> None:
    """Raises UserError unless there is a regular file at `path`."""
    try:
        check_file(path, "a recording")
    except UserError as error:
        if "Is a directory" in str(error):
            bags = sorted(file.name for kind in ("*.mcap", "*.db3") for file in path.glob(kind))
            hint = f", such as {path.name}/{bags[0]} in it" if bags else ""
            raise UserError(f"{path}: is a folder; expected a recording{hint}") from None
        if "no such file" not in str(error):
            raise
        beside = [other.name for other in path.parent.iterdir()] if path.parent.is_dir() else []
        hint = did_you_mean(path.name, beside[:2000])
        raise UserError(
            f"{path}: no such file{hint}; expected a recording (a card names it relative to itself)"
        ) from None


def _check_not_empty(path: Path) -> None:
    """Raises UserError where nothing was ever written to the file, whatever its format."""
    try:
        empty = path.stat().st_size == 0
    except OSError:  # reading it will say why
        return
    if empty:
        raise UserError(f"{path}: is empty (0 bytes); expected a recording")


def _check_no_workbook(path: Path, suffix: str) -> None:
    """Raises UserError where a spreadsheet has the name of a text file: its bytes would pass for names of columns."""
    if READERS.get(suffix) is read_csv and not path.is_dir():
        with path.open("rb") as file:
            kind = _FIRST_BYTES.get(file.read(4))
        if kind is not None:
            raise UserError(f"{path}: is {kind}, no text; {SAVE_AS_CSV}")


def _said(error: Exception) -> str:
    """A library's own words, on one line."""
    text = " ".join((getattr(error, "strerror", None) or str(error)).split())
    return text if len(text) <= 200 else f"{text[:200]}…"
