"""How a text file of samples is laid out: its encoding, what separates cells, the line of names, the line of units, the decimal sign.

All of it is found by looking for the columns that are asked for; nothing is guessed from the numbers alone. Column "#2" is the second
one of a file, whether or not it has a line of names.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import TextIO

from greybox_torch.data.readers.missing_marks import is_missing
from greybox_torch.data.readers.table import require
from greybox_torch.data.readers.text_rows import COMMENTS, DELIMITERS, is_number, rows_of, uncommented
from greybox_torch.data.readers.time_stamps import is_time_stamp
from greybox_torch.errors import UserError

HEAD = 300  # lines among which the line of names stands
_LONGEST_LINE = 2**20
_POSITION = re.compile(r"#([1-9]\d{0,5})")
_NO_UNIT = ("1", "-", "--", "---", "–", "—", "none", "n/a", "na")
"""What stands in a line of units for a column that has none; the first six say that it is a plain number."""
_UNIT = re.compile(r"[\[(]?[\w°%/·*^².\-–\s]{1,24}(\(\w{1,6}\))?[\])]?")


@dataclass(frozen=True)
class Layout:
    """Where things stand in a text file.

    `first` is the number of lines before the samples; `width` how many cells a line of samples has at least; `positions` where each column
    stands; `decimal` "." or ","; `units` of the columns, where the file has a line of them; `stamps` are the columns of dates or times of
    day; `names_line` counts from 1, 0 without names.
    """

    delimiter: str
    decimal: str
    first: int
    names_line: int
    width: int
    positions: dict[str, int]
    units: dict[str, str] = field(default_factory=dict)
    stamps: frozenset[str] = frozenset()

    def rows(self, file: TextIO) -> Iterator[tuple[int, list[str]]]:
        """Line and cells of everything behind the heading; a line of a cell with line breaks is its last. Raises csv.Error."""
        for _ in islice(file, self.first):
            pass
        return rows_of(file, self.delimiter, self.first)


def encoding_of(path: Path) -> str:
    """UTF-8 where the whole file is, UTF-16 where it says so, else Windows' 1252, which most instruments of other encodings write."""
    with path.open("rb") as file:
        if file.read(2) in (b"\xff\xfe", b"\xfe\xff"):
            return "utf-16"
    try:
        with path.open(encoding="utf-8") as text:
            while text.read(2**20):
                pass
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def layout_of(path: Path, file: TextIO, columns: Collection[str]) -> Layout:
    """The layout of the text in `file`, from its first lines. Raises UserError where a column is nowhere named."""
    head = []
    for line in islice(file, HEAD):
        if len(line) > _LONGEST_LINE:
            raise UserError(
                f"{path}, line {len(head) + 1}: has more than {_LONGEST_LINE} characters; expected lines of samples"
            )
        head.append(line)
    if not any(line.strip() for line in head):
        raise UserError(f"{path}: has nothing but blank lines; expected a line of column names, and lines of samples")
    wanted = [column for column in columns if not _POSITION.fullmatch(column)]
    numbered = {column: int(m[1]) - 1 for column in columns if (m := _POSITION.fullmatch(column))}
    found = _named(head, wanted, numbered) if wanted else _numbered(head, numbered)
    if found is None:
        names = _likely_names(head, wanted)
        require(path, wanted, names)
        if max(numbered.values()) >= len(names):
            raise UserError(
                f"{path}: no column {', '.join(numbered)}; found {len(names)} columns, the first of which is #1"
            )
        commas = "; if numbers have decimal commas, semicolons or tabs have to separate columns" * ("," in head[-1])
        raise UserError(
            f"{path}: no line among the first {len(head)} has a number in {', '.join(numbered)} and nothing but numbers beside it; "
            f"expected lines of samples{commas}"
        )
    delimiter, line, names = found
    _check_once(path, line, wanted, names)
    positions = {column: numbered[column] if column in numbered else names.index(column) for column in columns}
    after = [row for _, row in rows_of(iter(head[line:]), delimiter, line, strict=False)]
    units = _units(after, positions) if line and after else None
    samples = after[units is not None :]
    least = max(positions.values()) + 1
    width = len(names) if line else least
    if (
        line and samples and delimiter != " "
    ):  # the last columns may have a name and never a cell, as LabVIEW's comments
        width = max(least, min(width, len(samples[0])))
    return Layout(
        delimiter=delimiter,
        decimal=_decimal(delimiter, after, positions),
        first=line + (units is not None) if line else _before_numbers(head, delimiter, positions),
        names_line=line,
        width=width,
        positions=positions,
        units=units or {},
        stamps=frozenset(column for column, p in positions.items() if is_time_stamp(_first(samples, p))),
    )


def _first(rows: list[list[str]], position: int) -> str:
    """The first cell at a position that is not empty and no mark of a missing sample."""
    cells = (row[position].strip() for row in rows if position < len(row))
    return next((cell for cell in cells if cell and not is_missing(cell)), "")


def _named(head: list[str], wanted: list[str], numbered: dict[str, int]) -> tuple[str, int, list[str]] | None:
    """Delimiter, number and cells of the first line that names all columns; of several delimiters the one that gives most cells."""
    best: tuple[str, int, list[str]] | None = None
    for delimiter in DELIMITERS:
        for line, row in rows_of(iter(head), delimiter, 0, strict=False):
            if best is not None and line > best[1]:
                break
            names = [name.strip() for name in row]
            names = names if set(wanted) <= set(names) and names[0] not in COMMENTS else uncommented(names)
            if set(wanted) <= set(names) and all(k < len(names) for k in numbered.values()):
                rank = (line, delimiter == " ", -len(names))
                if best is None or rank < (best[1], best[0] == " ", -len(best[2])):
                    best = delimiter, line, names
                break
    return best


def _numbered(head: list[str], numbered: dict[str, int]) -> tuple[str, int, list[str]] | None:
    """Without names: the delimiter that gives most columns of numbers, and no line of names."""
    best: tuple[str, int, list[str]] | None = None
    for delimiter in DELIMITERS:
        before = _before_numbers(head, delimiter, numbered)
        row = next((row for _, row in rows_of(iter(head[before:]), delimiter, before, strict=False)), [])
        cells = [cell.strip() for cell in row]
        fits = bool(cells) and all(k < len(cells) for k in numbered.values())
        whole = all(is_number(cell, delimiter) or is_missing(cell) for cell in cells)
        if fits and whole and (best is None or len(cells) > len(best[2])):
            best = delimiter, 0, cells
    return best


def _before_numbers(head: list[str], delimiter: str, positions: dict[str, int]) -> int:
    """How many lines stand before the first with numbers, whose cells are numbers or marks of missing samples at the positions."""
    for k, text in enumerate(head):
        row = next((row for _, row in rows_of(iter([text]), delimiter, k, strict=False)), [])
        cells = [row[p].strip() for p in positions.values() if p < len(row)]
        sampled = any(cell.strip() and is_number(cell.strip(), delimiter) for cell in row)
        known = all(is_number(cell, delimiter) or is_missing(cell) for cell in cells)
        if sampled and len(cells) == len(positions) and any(cells) and known:
            return k
    return len(head)


def _likely_names(head: list[str], wanted: list[str]) -> list[str]:
    """For a message: the line that names most of the columns, else the first, split where it gives most cells."""
    rows = [
        [cell.strip() for cell in row] for d in DELIMITERS[:4] for _, row in rows_of(iter(head), d, 0, strict=False)
    ]
    named = max(rows, key=lambda row: len(set(wanted) & set(row)), default=[])
    if set(wanted) & set(named):
        return named
    first = [
        [cell.strip() for cell in row] for d in DELIMITERS[:4] for _, row in rows_of(iter(head[:1]), d, 0, strict=False)
    ]
    return max(first, key=len, default=[])


def _check_once(path: Path, line: int, wanted: list[str], names: list[str]) -> None:
    for column in wanted:
        if names.count(column) > 1:
            raise UserError(f'{path}, line {line}: {names.count(column)} columns are named "{column}"; expected one')


def _units(rows: list[list[str]], positions: dict[str, int]) -> dict[str, str] | None:
    """The units in the line beneath the names: text in every column that is not empty there, and no mark of a missing sample. Where columns
    without a unit have such a mark, text above numbers elsewhere in the line tells that it has units.
    """
    row = [cell.strip() for cell in rows[0]]
    if any(cell and is_number(cell, "") and cell not in _NO_UNIT for cell in row):
        return None  # samples, whatever else a logger writes in the place of one
    given = {column: row[p] for column, p in positions.items() if p < len(row) and row[p]}
    if not ((given and all(map(_looks_like_unit, given.values()))) or _are_units(row, rows[1:])):
        return None
    told = {column: _without_brackets(cell) for column, cell in given.items()}
    plain = {column: "1" if unit in _NO_UNIT[:6] else unit for column, unit in told.items()}
    return {column: unit for column, unit in plain.items() if unit and unit.lower() not in _NO_UNIT[6:]}


def _without_brackets(cell: str) -> str:
    """A unit without the brackets around it; those behind it, as of "bar(g)", are its own."""
    return cell.strip("[]() ") if cell[:1] in "[(" and "(" not in cell[1:] else cell.strip("[] ")


def _are_units(row: list[str], beneath: list[list[str]]) -> bool:
    """Whether all cells that are not empty are units or say that there is none, and numbers stand beneath one of the units."""
    units = [p for p, cell in enumerate(row) if cell and _looks_like_unit(cell)]
    others = [cell for cell in row if cell and not _looks_like_unit(cell)]
    above_numbers = any(is_number(cell, "") for p in units if (cell := _first(beneath, p)))
    return above_numbers and all(cell.lower() in _NO_UNIT for cell in others)


def _looks_like_unit(cell: str) -> bool:
    return not is_number(cell, "") and not is_missing(cell) and _UNIT.fullmatch(cell) is not None


def _decimal(delimiter: str, rows: list[list[str]], positions: dict[str, int]) -> str:
    """A decimal comma is one where commas do not separate cells and a number of the first lines has one."""
    if delimiter == ",":
        return "."
    cells = [row[p].strip() for row in rows for p in positions.values() if p < len(row)]
    return "," if any("," in cell and is_number(cell, delimiter) for cell in cells) else "."
