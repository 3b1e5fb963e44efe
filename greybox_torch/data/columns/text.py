"""The columns of text files: the names above the first numbers, or positions where there are none."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from greybox_torch.data.columns.listing import MOST_COLUMNS, Listing
from greybox_torch.data.readers.text_layout import DELIMITERS, HEAD, cells_of, encoding_of, is_number
from greybox_torch.errors import UserError


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
    names = _names(rows, first, width)
    return Listing(path, tuple(names[:MOST_COLUMNS]))


def _block(head: list[str], delimiter: str) -> tuple[list[list[str]], int, int, float] | None:
    """Cells of all lines, the first line of samples, how many cells it has, and what share of them are numbers.

    None where no two such lines follow each other. A column of text beside the numbers is no hindrance.
    """
    rows = [cells_of(line, delimiter) for line in head]
    shares = [_share(row, delimiter) for row in rows]
    for k, (row, share) in enumerate(zip(rows, shares, strict=True)):
        last = k + 1 == len(rows)
        if share >= 0.5 and (last or (shares[k + 1] >= 0.5 and len(rows[k + 1]) == len(row))):
            return rows, k, len(row), share
    return None


def _share(row: list[str], delimiter: str) -> float:
    """What share of the cells that are not empty are numbers."""
    filled = [cell for cell in row if cell]
    return sum(is_number(cell, delimiter) for cell in filled) / len(filled) if filled else 0.0


def _names(rows: list[list[str]], first: int, width: int) -> list[str]:
    """The line above the samples with a different name for every cell; of two such lines the upper, since the lower has the units."""
    above = [row for row in rows[max(0, first - 2) : first] if _is_heading(row, width)]
    for row in above:
        names = [name for name in row[:width] if name]
        if len(set(names)) == len(names):
            return names
    return [f"#{k}" for k in range(1, width + 1)]


def _is_heading(row: list[str], width: int) -> bool:
    """Whether a row has text in all cells that samples have, but perhaps one."""
    cells = [cell for cell in row[:width] if cell]
    return len(cells) >= max(1, width - 1) and not any(is_number(cell, "") for cell in cells)
