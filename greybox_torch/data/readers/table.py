"""What every reader returns, and the checks that readers share."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.checks import KINDS
from greybox_torch.data.readers.order_of_dates import OrderOfDates
from greybox_torch.errors import UserError, did_you_mean

MOST_SAMPLES = 200_000_000
"""Most samples of a column. What a file declares beyond that is not believed, so that nobody allocates it."""

MOST_UNPACKED = 1032
"""Bytes that a byte of deflate gives at most."""


class NoSuchColumn(UserError):
    """A file does not have the column `column`."""

    def __init__(self, message: str, column: str) -> None:
        super().__init__(message)
        self.column = column


class BadCell(UserError):
    """A cell of a file of text is no number, or no time stamp where the others are: ``cell`` is its text, ``mark`` whether that may stand
    for a missing sample.
    """

    def __init__(self, message: str, cell: str, *, mark: bool) -> None:
        super().__init__(message)
        self.cell, self.mark = cell, mark


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of a file as float64 arrays of shape (N,), and where the format has lines, the line of every sample.

    `units` are by column, where the file says them; `notes` say what was done to the samples while reading. `stamps` are columns that the
    file has as dates or times of day, where the reader tells; `dates`, by column, what it tells of dates such as 03/04/2026.
    """

    path: Path
    columns: dict[str, NDArray[np.float64]]
    lines: Sequence[int] | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    stamps: frozenset[str] = frozenset()
    dates: Mapping[str, OrderOfDates] = field(default_factory=dict)

    def place(self, column: str, sample: int) -> str:
        """Where a sample stands in the file, to begin a message with."""
        line = "" if self.lines is None else f"line {self.lines[sample]}, "
        return f'{self.path}, {line}column "{column}", sample {sample} (the first is 0)'


def require(path: Path, columns: Iterable[str], found: Collection[str]) -> None:
    """Raises NoSuchColumn, a UserError, where one of the columns is not among those found in the file."""
    known = set(found)
    for column in columns:
        if column not in known:
            listed = list(found)
            raise NoSuchColumn(
                f'{path}: no column "{column}"{did_you_mean(column, listed[:2000])}; found {named(listed)}', column
            )


def named(columns: Sequence[str]) -> str:
    """The columns of a file, for a message; of very many the first."""
    more = f", … ({len(columns)} in all)" if len(columns) > 40 else ""
    return ", ".join(_shown(name) for name in columns[:40]) + more or "none"


def _shown(name: str) -> str:
    """A name from a file, which may be damaged."""
    return (name if name.isprintable() else ascii(name))[:80]


def check_declared(path: Path, column: str, samples: int, most: int) -> None:
    """Raises UserError where a file declares more samples than it can hold, before anything is allocated for them.

    Args:
        most: samples that the bytes of the file that belong to the column could at most be unpacked to.
    """
    if samples > MOST_SAMPLES or samples > most:
        raise UserError(
            f'{path}, column "{column}": declares {samples:.6g} samples, more than the file can hold or than {MOST_SAMPLES:.0e}; '
            "the file is damaged, or larger than is read at once"
        )


def as_vector(path: Path, column: str, values: NDArray) -> NDArray[np.float64]:
    """A row or column vector of real numbers as float64 of shape (N,).

    Raises UserError for any other shape, and for text, complex numbers, structures and whatever else is no number.
    """
    if values.dtype.kind in "mM":  # times and durations, in seconds
        missing, values = np.isnat(values), values.astype(f"{values.dtype.kind}8[ns]").astype(np.int64) * 1e-9
        values = np.where(missing, np.nan, values)
    if values.dtype.kind not in "fiub":
        what = "a structure" if values.dtype.names else KINDS.get(values.dtype.kind, str(values.dtype))
        raise UserError(f'{path}, column "{column}": holds {what}; expected real numbers')
    if values.ndim == 0 or max(values.shape) != values.size:
        advice = f'; one column of a matrix is written "{column}[:, 0]"' if values.ndim == 2 and values.size else ""
        raise UserError(
            f'{path}, column "{column}": has the shape {values.shape}; expected a row or column vector{advice}'
        )
    with np.errstate(over="ignore", invalid="ignore"):
        return values.reshape(-1).astype(np.float64)
