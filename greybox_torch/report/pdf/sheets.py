"""Sheets of A4 that are filled from top to bottom: lines of text, and places for pictures. Lengths in points, of which an inch has 72."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import lru_cache
from io import BytesIO

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.lines import Line2D

from greybox_torch.report.code_words import unmarked
from greybox_torch.report.style import STYLE

WIDTH, HEIGHT = 595.0, 842.0
MARGIN, FOOT = 54.0, 48.0
ROOM = WIDTH - 2 * MARGIN
"""What a line of text may take."""

INK, QUIET, RULE = "#1c2127", "#5a636e", "#d9dde2"
SPACING = 1.38
"""Distance of lines, in sizes of the letters."""


class Sheets:
    """Sheets so far, the last of which is being filled. ``foot`` stands beneath each, with its number."""

    def __init__(self, foot: str) -> None:
        self.foot = foot
        self.figures: list[Figure] = []
        self.top = 0.0
        self.turn()

    @property
    def left(self) -> float:
        """Height that is left on the sheet."""
        return HEIGHT - FOOT - self.top

    def turn(self) -> None:
        """Begin another sheet."""
        with mpl.rc_context(STYLE):
            self.figures.append(Figure(figsize=(WIDTH / 72.0, HEIGHT / 72.0)))
        self.top = MARGIN

    def need(self, height: float) -> None:
        """Begin another sheet where so much is not left on this one, and it holds anything."""
        if height > self.left and self.top > MARGIN:
            self.turn()

    def gap(self, height: float) -> None:
        """Leave some room, but not at the head of a sheet."""
        if self.top > MARGIN:
            self.top += height

    def text(
        self,
        text: str,
        size: float = 9.5,
        *,
        bold: bool = False,
        colour: str = INK,
        indent: float = 0.0,
        bullet: str = "",
        width: float = ROOM,
    ) -> None:
        """A paragraph, broken into lines and over sheets as it has to be."""
        for k, line in enumerate(broken(unmarked(text), width - indent, size, bold)):
            self.need(SPACING * size)
            if bullet and k == 0:
                self.write(bullet, MARGIN + indent - 9.0, self.top, size, colour=colour)
            self.write(line, MARGIN + indent, self.top, size, bold=bold, colour=colour)
            self.top += SPACING * size

    def title(self, title: str, needed: float = 90.0) -> None:
        """The title of a section, on the sheet where so much of what follows has room."""
        self.gap(16.0)
        self.need(needed)
        self.text(title, 13.0, bold=True)
        self.gap(4.0)

    def write(
        self,
        text: str,
        x: float,
        y: float,
        size: float,
        *,
        bold: bool = False,
        colour: str = INK,
        align: str = "left",
        sheet: Figure | None = None,
    ) -> None:
        """One line whose upper end is ``y`` below the head of the sheet, by default the last one."""
        with mpl.rc_context(STYLE):
            (self.figures[-1] if sheet is None else sheet).text(
                x / WIDTH,
                1.0 - (y + 0.95 * size) / HEIGHT,
                text,
                fontsize=size,
                fontweight="bold" if bold else "normal",
                color=colour,
                ha=align,
                va="baseline",
            )

    def rule(self, x: float = MARGIN, width: float = ROOM, colour: str = RULE, thick: float = 0.7) -> None:
        """A horizontal line here."""
        y = 1.0 - self.top / HEIGHT
        ends = [x / WIDTH, (x + width) / WIDTH]
        self.figures[-1].add_artist(Line2D(ends, [y, y], color=colour, linewidth=thick))

    def axes(self, x: float, y: float, width: float, height: float) -> Axes:
        """Axes whose upper left corner is at ``x``, ``y`` from that of the sheet."""
        with mpl.rc_context(STYLE):
            return self.figures[-1].add_axes((x / WIDTH, 1.0 - (y + height) / HEIGHT, width / WIDTH, height / HEIGHT))

    def printed(self, metadata: dict[str, object]) -> bytes:
        """The document as PDF."""
        at = HEIGHT - FOOT + 18.0
        for k, sheet in enumerate(self.figures):
            self.write(self.foot, MARGIN, at, 7.5, colour=QUIET, sheet=sheet)
            number = f"{k + 1} / {len(self.figures)}"
            self.write(number, WIDTH - MARGIN, at, 7.5, colour=QUIET, align="right", sheet=sheet)
        held = BytesIO()
        with warnings.catch_warnings(), mpl.rc_context(STYLE):
            warnings.simplefilter("ignore")  # of letters that the font does not have: boxes stand there
            with PdfPages(held, metadata=metadata) as pages:
                for figure in self.figures:
                    pages.savefig(figure)
        return held.getvalue()


def broken(text: str, width: float, size: float, bold: bool = False) -> list[str]:
    """The lines of a paragraph no wider than ``width``; a word that is wider stands alone and is cut."""
    lines: list[str] = []
    line = ""
    for word in text.replace(" %", "\u00a0%").split(" "):
        longer = f"{line} {word}" if line else word
        if wide(longer, size, bold) <= width:
            line = longer
            continue
        if line:
            lines.append(line)
        *whole, line = _cut(word, width, size, bold)
        lines += whole
    return [*lines, line] if line or not lines else lines


def _cut(word: str, width: float, size: float, bold: bool) -> Sequence[str]:
    pieces = [""]
    for letter in word:
        if pieces[-1] and wide(pieces[-1] + letter, size, bold) > width:
            pieces.append("")
        pieces[-1] += letter
    return pieces


def wide(text: str, size: float, bold: bool = False) -> float:
    """Width of a line of text."""
    return size * sum(_width(letter, bold) for letter in text)


@lru_cache(maxsize=4096)
def _width(letter: str, bold: bool) -> float:
    """Width of a letter of size one."""
    font = get_font(findfont(FontProperties(weight="bold" if bold else "normal")))
    if not font.get_char_index(ord(letter)):
        return 0.6  # of the box that stands for a letter that the font does not have
    font.set_size(100.0, 72.0)
    return font.load_char(ord(letter)).linearHoriAdvance / 65536.0 / 100.0
