"""Comma-separated text: a line of column names, then one line a sample. Empty cells and NaN are missing samples.

The standard library's parser serves better here than pandas: numbers come out exact to the last bit, every fault has
its line, and four files of 20 000 samples are read in less time than importing pandas takes.
"""

from __future__ import annotations

import csv
from array import array
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.data.readers.table import Table, require
from greybox_torch.errors import UserError


def read_csv(path: Path, columns: Collection[str]) -> Table:
    """Reads columns by their names in the first line. Raises UserError with the line of whatever is no number."""
    with path.open(newline="", encoding="utf-8-sig") as file:
        rows = csv.reader(file, skipinitialspace=True)
        try:
            names = [name.strip() for name in next(rows, [])]
            _check_names(path, columns, names)
            return _read_samples(path, rows, {column: names.index(column) for column in columns}, len(names))
        except UnicodeDecodeError:
            raise UserError(f"{path}: not UTF-8 text, after line {rows.line_num}; expected UTF-8") from None
        except csv.Error as error:
            raise UserError(f"{path}, line {rows.line_num}: not comma-separated values: {error}") from None


def _check_names(path: Path, columns: Collection[str], names: list[str]) -> None:
    require(path, columns, names)
    for column in columns:
        if names.count(column) > 1:
            raise UserError(f'{path}, line 1: {names.count(column)} columns are named "{column}"; expected one')


def _read_samples(path: Path, rows: Any, positions: dict[str, int], width: int) -> Table:
    lines = array("q")
    values = {column: array("d") for column in positions}
    for line, row in _samples(path, rows, width):
        lines.append(line)
        for column, position in positions.items():
            cell = row[position].strip()
            try:
                values[column].append(float(cell or "nan"))
            except ValueError:
                raise UserError(
                    f'{path}, line {line}, column "{column}": found "{cell}", expected a number '
                    "(missing samples are empty cells or NaN)"
                ) from None
    return Table(path, {column: np.array(samples) for column, samples in values.items()}, lines)


def _samples(path: Path, rows: Any, width: int) -> Iterator[tuple[int, list[str]]]:
    """The line and the cells of every sample.

    A blank line between others is a missing sample: dropping it would shift all that follow in time. At the end of the
    file it is nothing.
    """
    blank_lines: list[int] = []
    for row in rows:
        if len(row) < width and not "".join(row).strip():
            blank_lines.append(rows.line_num)
            continue
        yield from ((line, [""] * width) for line in blank_lines)
        blank_lines.clear()
        if len(row) < width or "".join(row[width:]).strip():
            raise UserError(
                f"{path}, line {rows.line_num}: found {len(row)} cell(s), expected {width}, one for each name in line 1; "
                "commas separate cells, and decimals have a point"
            )
        yield rows.line_num, row
