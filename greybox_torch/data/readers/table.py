"""What every reader returns, and the checks that readers share."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.errors import UserError, did_you_mean


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of a file as float64 arrays of shape (N,), and where the format has lines, the line of every sample."""

    path: Path
    columns: dict[str, NDArray[np.float64]]
    lines: Sequence[int] | None = None

    def place(self, column: str, sample: int) -> str:
        """Where a sample stands in the file, to begin a message with."""
        line = "" if self.lines is None else f"line {self.lines[sample]}, "
        return f'{self.path}, {line}column "{column}", sample {sample} (the first is 0)'


def require(path: Path, columns: Iterable[str], found: Collection[str]) -> None:
    """Raises UserError where one of the columns is not among those found in the file."""
    for column in columns:
        if column not in found:
            known = ", ".join(found) or "none"
            raise UserError(f'{path}: no column "{column}"{did_you_mean(column, found)}; found {known}')


def as_vector(path: Path, column: str, values: NDArray) -> NDArray[np.float64]:
    """A row or column vector of real numbers as float64 of shape (N,).

    Raises UserError for any other shape, and for text, complex numbers, structures and whatever else is no number.
    """
    if values.dtype.kind not in "fiub":
        kind = {"U": "text", "S": "text", "c": "complex numbers", "O": "cells or objects", "V": "a structure"}
        what = kind.get(values.dtype.kind, str(values.dtype))
        raise UserError(f'{path}, column "{column}": holds {what}; expected real numbers')
    if values.ndim == 0 or max(values.shape) != values.size:
        raise UserError(f'{path}, column "{column}": has the shape {values.shape}; expected a row or column vector')
    return values.reshape(-1).astype(np.float64)
