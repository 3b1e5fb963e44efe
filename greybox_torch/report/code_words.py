"""What sentences set between backticks, which a terminal shows as they are: a command or a name to write, as pages and sheets set it."""

from __future__ import annotations

import re

_BETWEEN = re.compile(r"`([^`]+)`")


def marked(escaped: str) -> str:
    """A sentence that is escaped for HTML already, with what stands between backticks as code."""
    return _BETWEEN.sub(r"<code>\1</code>", escaped)


def unmarked(sentence: str) -> str:
    """A sentence without backticks, where letters of one kind are all there are."""
    return _BETWEEN.sub(r"\1", sentence)
