"""Sections that others have registered, on a sheet: their templates are HTML, of which the text is printed.

Headings, paragraphs, lists and tables stand as on the page; pictures do not, and a line says so.
"""

from __future__ import annotations

from html.parser import HTMLParser

from greybox_torch.report.pdf.sheets import QUIET, Sheets

HEADINGS = frozenset({"h1", "h2", "h3", "h4"})
BLOCKS = frozenset(
    ["p", "li", "tr", "dt", "dd", "figcaption", "pre", "div", "section", "table", "ul", "ol", "blockquote"]
)
SILENT = frozenset({"script", "style", "title"})
PICTURES = frozenset({"svg", "img", "canvas"})
PICTURE = "(A picture that stands on the page.)"


class Text(HTMLParser):
    """The text of a piece of HTML: ``lines`` of (tag of the block, text)."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.lines: list[tuple[str, str]] = []
        self._block, self._silent = "p", 0
        self._cells: list[list[str]] = [[]]

    @staticmethod
    def of(html: str) -> list[tuple[str, str]]:
        """The blocks of ``html`` that hold text."""
        read = Text()
        read.feed(html)
        read.close()
        read.end_block()
        return read.lines

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in PICTURES and not self._silent:
            self.end_block()
            self.lines.append(("picture", PICTURE))
        if tag in SILENT or (tag in PICTURES and tag != "img"):
            self._silent += 1
        if tag in HEADINGS or tag in BLOCKS:
            self.end_block()
            self._block = tag
        if tag in ("td", "th"):
            self._cells.append([])

    def handle_endtag(self, tag: str) -> None:
        if tag in SILENT or (tag in PICTURES and tag != "img"):
            self._silent = max(0, self._silent - 1)
        if tag in HEADINGS or tag in BLOCKS:
            self.end_block()
            self._block = "p"

    def handle_data(self, data: str) -> None:
        if not self._silent:
            self._cells[-1].append(data)

    def end_block(self) -> None:
        """Keeps what was read since the last block began; the cells of a table's row stand apart."""
        cells = [" ".join("".join(cell).split()) for cell in self._cells]
        text = " · ".join(cell for cell in cells if cell)
        if text:
            self.lines.append((self._block, text))
        self._cells = [[]]


def draw_own(sheets: Sheets, html: str) -> None:
    """The text of a registered section's HTML."""
    for tag, text in Text.of(html):
        if tag in HEADINGS:
            sheets.title(text)
        elif tag == "li":
            sheets.text(text, indent=10.0, bullet="•")
        elif tag == "picture":
            sheets.text(text, 8.0, colour=QUIET)
        else:
            sheets.text(text)
        sheets.gap(2.0)
