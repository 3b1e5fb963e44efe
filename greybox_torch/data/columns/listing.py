"""The columns of a file, and the walk through nested values that finds them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.data.readers.missing_marks import is_missing
from greybox_torch.data.readers.time_stamps import is_time_stamp

MOST_COLUMNS = 400
"""Most columns that are listed of a file."""

_WIDEST = 64
"""Most columns or rows of a matrix that are taken for channels."""


@dataclass(frozen=True)
class Listing:
    """Names of columns in the order of the file; single numbers, such as a sample time, by name."""

    path: Path
    names: tuple[str, ...]
    numbers: Mapping[str, float] = field(default_factory=dict)

    @staticmethod
    def of_parts(path: Path, parts: Iterator[tuple[str, Any]]) -> Listing:
        """The columns among named arrays, lists and structures."""
        names: list[str] = []
        numbers: dict[str, float] = {}
        for name, value in parts:
            for column, found in walk(name, value):
                if isinstance(found, float):
                    numbers[column] = found
                elif len(names) < MOST_COLUMNS:
                    names.append(column)
        return Listing(path, tuple(names), numbers)


def walk(name: str, value: Any) -> Iterator[tuple[str, float | None]]:
    """The columns in a value, each with None, or with its value where it is one number."""
    while isinstance(value, np.ndarray) and value.dtype.kind == "O" and value.size == 1 and value.ndim:
        value = value.flat[0]
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from walk(f"{name}.{key}", inner)
    elif isinstance(value, bool | int | float):
        yield name, float(value)
    elif isinstance(value, list) and value and all(is_sample(v) for v in value):
        yield name, None
    elif isinstance(value, list) and (shape := _shape(value)):
        yield from of_shape(name, shape)
    elif isinstance(value, list) and value and all(isinstance(v, Mapping | list) for v in value[:50]):
        for k, inner in enumerate(value[:50]):
            yield from walk(f"{name}[{k}]", inner)
    elif isinstance(value, np.ndarray) and value.dtype.kind == "O":
        for k, inner in enumerate(value.ravel(order="F")[:50]):
            yield from walk(f"{name}[{k}]", inner)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "fiubmM":
        yield from of_shape(
            name, value.shape, float(value.flat[0]) if value.size == 1 and value.dtype.kind in "fiub" else None
        )


def is_sample(value: Any) -> bool:
    """Whether a value of JSON may be a sample: a number, a missing one, or a time stamp."""
    return isinstance(value, bool | int | float | None) or (
        isinstance(value, str) and (is_time_stamp(value) or is_missing(value.strip()))
    )


def _shape(value: list[Any]) -> tuple[int, int] | None:
    """Rows and columns of a list of lists of numbers, all of one length."""
    if not value or not all(isinstance(row, list) and len(row) == len(value[0]) for row in value):
        return None
    numbers = all(isinstance(cell, bool | int | float | None) for row in value for cell in row)
    return (len(value), len(value[0])) if numbers else None


def of_shape(name: str, shape: tuple[int, ...], number: float | None = None) -> Iterator[tuple[str, float | None]]:
    """The columns in an array of numbers of that shape; ``number`` where it holds one."""
    size = int(np.prod(shape, dtype=object))
    if size == 1:
        yield name, number
    elif size and max(shape) == size:
        yield name, None
    elif len(shape) == 2 and 1 < min(shape) <= _WIDEST:
        rows, columns = shape
        for k in range(min(shape)):
            yield (f"{name}[:, {k}]" if rows >= columns else f"{name}[{k}, :]"), None
