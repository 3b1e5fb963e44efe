"""Samples as text: perhaps some lines about the recording, a line of column names, perhaps one of units, then one line a sample.

Commas, semicolons, tabs, bars or spaces separate cells; decimals have a point, or a comma where commas do not separate. Empty cells,
NaN and the usual marks of missing samples, such as "---" and "N/A", are missing samples.

The standard library's parser serves better here than pandas: numbers come out exact to the last bit, every fault has
its line, and four files of 20 000 samples are read in less time than importing pandas takes.
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Collection, Iterator
from itertools import repeat
from pathlib import Path
from typing import TextIO

import numpy as np

from greybox_torch.data.readers.clean_rows import clean_rows
from greybox_torch.data.readers.missing_marks import is_missing
from greybox_torch.data.readers.table import BadCell, Table
from greybox_torch.data.readers.text_layout import Layout, encoding_of, layout_of
from greybox_torch.data.readers.text_rows import UnreadableRow
from greybox_torch.data.readers.time_stamps import UNDERSTOOD, TimeStamps, looks_like_a_date
from greybox_torch.errors import UserError
from greybox_torch.files import toml_text


def read_csv(path: Path, columns: Collection[str], marks: Collection[tuple[str, str]] = ()) -> Table:
    """Reads columns by their names, or by "#2" for the second. Raises UserError with the line of whatever is no number.

    Args:
        marks: pairs of a column and a text that is a missing sample in it, beside the usual ones.
    """
    try:
        with path.open(newline="", encoding=encoding_of(path)) as file:
            layout = layout_of(path, file, columns)
            file.seek(0)
            if (plain := clean_rows(file, layout)) is not None:
                lines, values = plain
                return Table(path, {name: np.array(samples) for name, samples in values.items()}, lines, layout.units)
            file.seek(0)
            return _read_samples(path, file, layout, frozenset(marks))
    except UnicodeError:
        raise UserError(f"{path}: not text in UTF-8, UTF-16 or Windows-1252; expected one of them") from None
    except UnreadableRow as error:
        raise UserError(f"{path}, line {error.line}: not comma-separated values: {error}") from None


def _read_samples(path: Path, file: TextIO, layout: Layout, marks: frozenset[tuple[str, str]]) -> Table:
    found: Counter[tuple[str, str]] = Counter()
    lines = array("q")
    values = {column: array("d") for column in layout.positions}
    written: dict[str, list[str]] = {column: [] for column in layout.stamps}
    places = [(column, position, values[column].append) for column, position in layout.positions.items()]
    for line, row in _samples(path, file, layout):
        lines.append(line)
        for column, position, append in places:
            cell = row[position].strip()
            if is_missing(cell) or (column, cell) in marks:
                found[column, cell] += 1
                cell = ""
            if column in written:
                written[column].append(cell)
            else:
                append(_number(path, line, column, cell, layout.decimal))
    notes, dates = list(_told(path, found)), {}
    for column, cells in written.items():  # all of a column tell which number of a date is the day
        stamps = TimeStamps(cells)
        values[column].extend(_seconds(path, *at, stamps) for at in zip(lines, repeat(column), cells))
        notes += [f'column "{column}" of {path.name}: {stamps.note}'] if stamps.note else []
        dates |= {column: stamps.order} if stamps.order else {}
    units = layout.units | dict.fromkeys(written, "s")
    columns = {column: np.array(samples) for column, samples in values.items()}
    return Table(path, columns, lines, units, tuple(notes), layout.stamps, dates)


def _told(path: Path, found: Counter[tuple[str, str]]) -> tuple[str, ...]:
    """Of the marks of missing samples, which nobody but us took for that."""
    return tuple(
        f'column "{column}" of {path.name}: "{mark:.20}" is read as a missing sample, {count} time{"s" * (count > 1)}'
        for (column, mark), count in found.items()
    )


def _seconds(path: Path, line: int, column: str, cell: str, stamps: TimeStamps) -> float:
    try:
        return stamps.seconds(cell) if cell else float("nan")
    except ValueError as error:
        _refuse_names(path, line, column, cell)
        message = f'{path}, line {line}, column "{column}": found "{cell:.60}": {error}'
        raise BadCell(message, cell, mark=False) from None


def _number(path: Path, line: int, column: str, cell: str, decimal: str) -> float:
    """A cell's number. Python would take 1_000 and digits of other scripts as well, which no instrument writes on purpose."""
    try:
        if cell.isascii() and "_" not in cell:
            if decimal == ",":
                if "." in cell and cell.strip("+-0."):  # a zero is one with either sign
                    raise ValueError
                cell = cell.replace(",", ".", 1)
            return float(cell or "nan")
    except ValueError:
        pass
    _refuse_names(path, line, column, cell)
    sign = "; decimals have a comma in this file" if decimal == "," else ""
    mark = not any(character.isdigit() for character in cell)
    if looks_like_a_date(cell):
        sign += f"; it looks like a date or a time of day; {UNDERSTOOD}"
    if mark:
        sign += f"; if this is another one, missing = {toml_text(cell[:60])} in the channel's line on the card"
    raise BadCell(
        f'{path}, line {line}, column "{column}": found "{cell:.60}", expected a number '
        f"(missing samples are empty cells, NaN, or marks such as --- and N/A{sign})",
        cell,
        mark=mark,
    ) from None


def _refuse_names(path: Path, line: int, column: str, cell: str) -> None:
    """Raises UserError where a cell among the samples is the name of its column: a logger that is started anew writes its heading again."""
    if cell.strip().strip('"') == column:
        raise UserError(
            f"{path}, line {line}: found the names of the columns again, as where the logger was started anew; expected the file divided "
            "there, an experiment for each part, or, where time runs on without a gap, this line deleted"
        ) from None


def _samples(path: Path, file: TextIO, layout: Layout) -> Iterator[tuple[int, list[str]]]:
    """The line and the cells of every sample.

    A blank line between others is a missing sample: dropping it would shift all that follow in time. At the end of the
    file it is nothing.
    """
    width, blank_lines = layout.width, []
    for line, row in layout.rows(file):
        if len(row) < width and not "".join(row).strip():
            blank_lines.append(line)
            continue
        yield from ((blank, [""] * width) for blank in blank_lines)
        blank_lines.clear()
        if len(row) < width or (layout.names_line and "".join(row[width:]).strip()):
            for_names = f", one for each name in line {layout.names_line}" if layout.names_line else ""
            raise UserError(
                f"{path}, line {line}: found {len(row)} cell(s), expected {width}{for_names}; "
                f"{_WORDS[layout.delimiter]} separate cells"
                + (", and decimals have a point" if layout.delimiter == "," else "")
            )
        yield line, row


_WORDS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "spaces"}
