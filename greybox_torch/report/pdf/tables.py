"""Tables and bars on a sheet."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.report.pdf.sheets import INK, MARGIN, QUIET, ROOM, RULE, SPACING, Sheets, broken

SIZE, SMALL = 8.5, 7.5
Cell = tuple[str, str]
"""What a cell says, and in small letters beneath it."""


def draw_table(
    sheets: Sheets,
    heads: Sequence[Cell],
    rows: Sequence[Sequence[Cell]],
    widths: Sequence[float],
    *,
    bold_last: bool = False,
) -> None:
    """Rows under headings; the first column to the left, the others to the right. ``widths`` are shares of the line."""
    places = [sum(widths[:k]) * ROOM for k in range(len(widths))]
    if heads:
        _row(sheets, heads, places, widths, head=True)
    for row in rows:
        _row(sheets, row, places, widths, bold_last=bold_last)


def _row(
    sheets: Sheets,
    cells: Sequence[Cell],
    places: Sequence[float],
    widths: Sequence[float],
    *,
    head: bool = False,
    bold_last: bool = False,
) -> None:
    folded = [
        (broken(text, share * ROOM - 8.0, SIZE, head), broken(beneath, share * ROOM - 8.0, SMALL) if beneath else [])
        for (text, beneath), share in zip(cells, widths, strict=True)
    ]
    height = max(SPACING * (SIZE * len(text) + SMALL * len(beneath)) for text, beneath in folded) + 6.0
    sheets.need(height + (40.0 if head else 0.0))
    for k, ((text, beneath), place, share) in enumerate(zip(folded, places, widths, strict=True)):
        x, align = (MARGIN + place, "left") if k == 0 else (MARGIN + place + share * ROOM, "right")
        y = sheets.top + 3.0
        for line in text:
            sheets.write(line, x, y, SIZE, bold=head or (bold_last and k == len(folded) - 1), align=align)
            y += SPACING * SIZE
        for line in beneath:
            sheets.write(line, x, y, SMALL, colour=QUIET, align=align)
            y += SPACING * SMALL
    sheets.top += height
    sheets.rule(colour=QUIET if head else RULE)


def draw_bars(sheets: Sheets, rows: Sequence[tuple[str, float, str, str]]) -> None:
    """Bars beside each other: what each stands for, its length from 0 to 1, what is written behind it, and its colour."""
    for name, length, value, colour in rows:
        lines = broken(name, 0.42 * ROOM, SIZE)
        sheets.need(SPACING * SIZE * len(lines) + 3.0)
        axes = sheets.axes(MARGIN + 0.45 * ROOM, sheets.top + 2.0, 0.4 * ROOM, 8.0)
        axes.set_axis_off()
        axes.set_xlim(0.0, 1.0)
        axes.barh([0.0], [max(length, 0.003)], color=colour, height=1.0)
        sheets.write(value, MARGIN + ROOM, sheets.top, SIZE, colour=INK, align="right")
        for line in lines:
            sheets.write(line, MARGIN, sheets.top, SIZE)
            sheets.top += SPACING * SIZE
        sheets.top += 3.0
