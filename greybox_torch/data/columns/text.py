"""The columns of text files: the names above the first numbers, or positions where there are none."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path

from greybox_torch.data.columns.listing import MOST_COLUMNS, Listing
from greybox_torch.data.readers.missing_marks import is_missing
from greybox_torch.data.readers.text_layout import HEAD, encoding_of
from greybox_torch.data.readers.text_rows import DELIMITERS, cells_of, is_number, uncommented
from greybox_torch.data.readers.time_stamps import is_time_stamp
from greybox_torch.data.units import is_unit
from greybox_torch.errors import UserError

_MARKED = re.compile(r"[-–%]|\[.*\]|\(.*\)")
"""What stands for a unit, or for none, whatever is in it."""
_LETTERS = frozenset("smhgVAWNJKlL")
"""Letters that stand for a unit alone; others, such as t for tonne and P for poise, more often name a signal."""


def text_columns(path: Path) -> Listing:
    """Raises UserError where no line of numbers is among the first."""
    try:
        with path.open(newline="", encoding=encoding_of(path)) as file:
            head = [line[: 2**20] for line in islice(file, HEAD)]
    except UnicodeError:
        raise UserError(f"{path}: not text in UTF-8, UTF-16 or Windows-1252; expected one of them") from None
    found = [block for delimiter in DELIMITERS if (block := _block(head, delimiter))]
    if not found:
        raise UserError(f"{path}: no line of numbers among the first {HEAD}; expected samples, one line each")
    rows, first, width, _ = max(found, key=lambda block: (block[3], block[2]))
    names = _names(rows, first, _filled(rows[max(0, first - 1) :], width))
    return Listing(path, tuple(names[:MOST_COLUMNS]))


def _block(head: list[str], delimiter: str) -> tuple[list[list[str]], int, int, float] | None:
    """Cells of all lines, the first line of samples, how many cells it has, and what share of them are numbers.

    The longest run of such lines is meant: about the recording there are often some lines of a name and a number. None where no two of them
    follow each other. A column of text beside the numbers is no hindrance.
    """
    rows = [cells_of(line, delimiter) for line in head]
    shares = [_share(row, delimiter) for row in rows]
    runs: dict[int, int] = {}  # lengths by first line
    first = 0
    for k, (row, share) in enumerate(zip(rows, shares, strict=True)):
        first = first if k and share >= 0.5 and shares[k - 1] >= 0.5 and len(rows[k - 1]) == len(row) else k
        if share >= 0.5:
            runs[first] = k + 1 - first
    start = max(runs, key=runs.__getitem__, default=None)
    if start is None or (runs[start] < 2 and start + 1 < len(rows)):
        return None
    return rows, start, len(rows[start]), shares[start]


def _filled(rows: list[list[str]], width: int) -> int:
    """How many columns there are without the last ones that have neither a name nor a cell: spreadsheets write them."""
    return max((k + 1 for row in rows for k, cell in enumerate(row[:width]) if cell), default=width)


def _share(row: list[str], delimiter: str) -> float:
    """What share of the cells that are neither empty nor marks of missing samples are numbers or time stamps."""
    filled = [cell for cell in row if cell and not is_missing(cell)]
    known = sum(is_number(cell, delimiter) or is_time_stamp(cell) for cell in filled)
    return known / len(filled) if filled else 0.0


def _names(rows: list[list[str]], first: int, width: int) -> list[str]:
    """The line above the samples with a different name for every cell; of two such lines the upper, since the lower has units, types or
    channels of the logger, but the lower beneath a remark on the recording.
    """
    above = rows[max(0, first - 2) : first]
    if above and uncommented(above[-1]) != above[-1]:
        above = above[-1:]  # of comments, the last
    found, remark = [], False
    for row in (names for names in map(uncommented, above) if _is_heading(names, width)):
        names = [name for name in row[:width] if name]
        if len(set(names)) == len(names):
            remark = remark or (not found and _is_remark(row, width))
            found.append(names)
    if not found:
        return [f"#{k}" for k in range(1, width + 1)]
    return found[1] if len(found) == 2 and remark and not _are_units(found[1], len(found[0])) else found[0]


def _is_remark(row: list[str], width: int) -> bool:
    """Whether a line may be about the recording, as "Bench 7; operator: K" is: a colon, or too few cells, which a first one without a
    name does not mean.
    """
    return any(":" in cell for cell in row) or not any(row[width - 1 : width])


def _are_units(cells: list[str], names: int) -> bool:
    """Whether a line of text beneath one of so many cells has their units, and no names beneath a line about the recording.

    One unit that is known is enough, since others may be "counts"; all of them, where the line above would leave one without a name.
    """
    letter = {cell: cell.rstrip("0123456789") for cell in cells}
    known = [
        _MARKED.fullmatch(cell) is not None or ((len(letter[cell]) != 1 or letter[cell] in _LETTERS) and is_unit(cell))
        for cell in cells
    ]
    return any(known) if names >= len(cells) else all(known)


def _is_heading(row: list[str], width: int) -> bool:
    """Whether a row has text in all cells that samples have, but perhaps one."""
    cells = [cell for cell in row[:width] if cell]
    return len(cells) >= max(1, width - 1) and not any(is_number(cell, "") for cell in cells)
