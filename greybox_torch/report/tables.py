"""Tables on the console."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

_WIDEST = 300
_NARROWEST = 12


def print_table(
    console: Console,
    columns: Sequence[str],
    numbers_and_texts: Sequence[Sequence[str | float]],
    *,
    prose: Sequence[str] = (),
    digits: int = 5,
) -> None:
    """Prints rows under the headings ``columns``; numbers go to the right, with so many digits.

    On a terminal that is too narrow the columns named in ``prose`` are folded, as far as that goes; elsewhere nothing is, so that lines
    can be searched.
    """
    table = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    rows = [[cell if isinstance(cell, str) else number(cell, digits) for cell in row] for row in numbers_and_texts]
    for k, heading in enumerate(columns):
        numeric, folds = any(not isinstance(row[k], str) for row in numbers_and_texts), heading in prose
        widest = max(len(line) for cell in (heading, *(row[k] for row in rows)) for line in cell.split("\n"))
        table.add_column(
            Text(heading),
            justify="right" if numeric else "left",
            no_wrap=not folds,
            min_width=min(widest, _NARROWEST) if folds else widest,
        )
    for row in rows:
        table.add_row(*[Text(cell) for cell in row])
    needed = Measurement.get(console, console.options.update(width=_WIDEST), table)
    width = min(max(console.width, needed.minimum), needed.maximum) if console.is_terminal else needed.maximum
    Console(file=console.file, width=width, highlight=False).print(table)


def number(value: float, digits: int = 5) -> str:
    """So many significant digits; a whole number, such as a count of samples, in full."""
    return str(value) if isinstance(value, int) else f"{value:.{digits}g}"
