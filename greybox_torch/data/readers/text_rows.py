"""Lines of text taken apart into cells."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator

DELIMITERS = (",", ";", "\t", "|", " ")
COMMENTS = ("#", "%")


def rows_of(
    lines: Iterable[str], delimiter: str, before: int, *, strict: bool = True
) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of each row; runs of spaces separate where the delimiter is a space."""
    if delimiter == " ":
        yield from ((before + k, line.split()) for k, line in enumerate(lines, start=1))
        return
    taken: list[str] = []
    rows = csv.reader(_kept(lines, taken), delimiter=delimiter, skipinitialspace=delimiter != "\t")
    last = 0
    while True:
        try:
            row = next(rows)
            if strict and len(taken) > 1:  # a cell with line breaks, or a quotation mark that is never closed
                list(csv.reader(taken, delimiter=delimiter, skipinitialspace=delimiter != "\t", strict=True))
        except StopIteration:
            return
        except csv.Error as error:
            if not strict:
                return
            raise UnreadableRow(before + last + 1, _said(error)) from None
        taken.clear()
        last = rows.line_num
        yield before + last, row


def _kept(lines: Iterable[str], taken: list[str]) -> Iterator[str]:
    for line in lines:
        taken.append(line)
        yield line


class UnreadableRow(Exception):
    """A row that begins in `line` cannot be taken apart."""

    def __init__(self, line: int, why: str) -> None:
        super().__init__(why)
        self.line = line


def _said(error: csv.Error) -> str:
    text = str(error)
    if "field larger" in text:
        return "a cell of more than 131072 characters, or a quotation mark that is opened here and not closed"
    if "unexpected end" in text:
        return "a quotation mark is opened here and not closed"
    return text


def cells_of(line: str, delimiter: str) -> list[str]:
    """The cells of one line; none of a line that cannot be taken apart."""
    return next(([cell.strip() for cell in row] for _, row in rows_of(iter([line]), delimiter, 0, strict=False)), [])


def is_number(cell: str, delimiter: str) -> bool:
    """Whether a cell holds a number, perhaps with a decimal comma, or is empty."""
    try:
        float((cell if delimiter == "," else cell.replace(",", ".", 1)) or "nan")
    except ValueError:
        return False
    return True


def uncommented(cells: list[str]) -> list[str]:
    """The cells of a line of names that is marked as a comment, as numpy's savetxt does."""
    first = cells[0].lstrip("".join(COMMENTS)) if cells and cells[0].startswith(COMMENTS) else None
    if first is None:
        return cells
    return [first.strip(), *cells[1:]] if first.strip() else cells[1:]
