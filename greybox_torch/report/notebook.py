"""What a notebook shows of a result: a heading, tables and pictures as HTML that needs no network."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING

from greybox_torch.report.code_words import marked
from greybox_torch.report.tables import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STYLE = """\
.greybox { font-family: system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, "DejaVu Sans", sans-serif; }
.greybox { font-size: 13px; line-height: 1.45; max-width: 980px; }
.greybox p { margin: 0.3em 0; }
.greybox .title { font-weight: 600; font-size: 1.1em; }
.greybox .found { font-weight: 600; }
.greybox .note { opacity: 0.75; }
.greybox table { font-size: inherit; border-collapse: collapse; margin: 0.5em 0 0.8em; font-variant-numeric: tabular-nums; }
.greybox th, .greybox td { padding: 2px 12px 2px 0; text-align: left; vertical-align: top; background: none; white-space: normal; }
.greybox th { font-weight: 600; border-bottom: 1px solid rgba(128, 128, 128, 0.6); vertical-align: bottom; white-space: pre-line; }
.greybox th.number, .greybox td.number { text-align: right; white-space: pre; }
.greybox th.number { white-space: pre-line; }
.greybox tbody tr + tr td { border-top: 1px solid rgba(128, 128, 128, 0.2); }
.greybox pre { white-space: pre-wrap; margin: 0.4em 0; }
.greybox img { display: block; max-width: 100%; height: auto; background: white; margin: 0.4em 0; }
"""


def page(title: str, *parts: str) -> str:
    """The parts under a heading."""
    return f'<div class="greybox"><style>{_STYLE}</style><p class="title">{escape(title)}</p>{"".join(parts)}</div>'


def sentence(text: str, kind: str = "note") -> str:
    """A paragraph; ``kind`` "found" is the one that matters, "note" one that explains."""
    return f'<p class="{kind}">{marked(escape(text))}</p>'


def table(columns: Sequence[str], rows: Sequence[Sequence[str | float]], digits: int = 5) -> str:
    """Rows under headings; numbers go to the right, with so many digits."""
    numeric = [any(not isinstance(row[k], str) for row in rows) for k in range(len(columns))]
    head = "".join(_cell("th", heading, right, digits) for heading, right in zip(columns, numeric, strict=True))
    body = "".join(
        f"<tr>{''.join(_cell('td', c, right, digits) for c, right in zip(row, numeric, strict=True))}</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def verbatim(text: str) -> str:
    """Text as it stands, line by line."""
    return f"<pre>{escape(text)}</pre>"


def picture(figure: Figure, alt: str) -> str:
    """The figure as an image within the page."""
    text = base64.b64encode(png(figure, dots_per_inch=min(90.0, figure.dpi))).decode()
    return f'<img alt="{escape(alt, quote=True)}" src="data:image/png;base64,{text}">'


def png(figure: Figure, dots_per_inch: float | None = None) -> bytes:
    """The figure as the bytes of a PNG file."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=dots_per_inch or figure.dpi)
    return buffer.getvalue()


def _cell(tag: str, content: str | float, right: bool, digits: int) -> str:
    text = content if isinstance(content, str) else number(content, digits)
    kind = ' class="number"' if right else ""
    return f"<{tag}{kind}>{escape(text)}</{tag}>"
