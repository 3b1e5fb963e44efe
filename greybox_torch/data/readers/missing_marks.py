"""Text that loggers and spreadsheets write where a sample is missing, and that no signal could mean."""

from __future__ import annotations

import re

_MARK = re.compile(
    r"[-–—]+|\?|n\.?/?a\.?|#n/?a!?|#nv|#?null!?|none|nil|missing|k\.\s?a\.|-?nan\(\w*\)|[+-]?1[.,]#(qnan|snan|ind|nan)\d*",
    re.IGNORECASE,
)
"""Dashes, the words of programming languages, of spreadsheets (English and German), and Windows' numbers that are none."""


def is_missing(cell: str) -> bool:
    """Whether a cell, without the spaces around it, says that there is no sample. An empty cell and "nan", which are numbers to Python, are
    not asked about.
    """
    return _MARK.fullmatch(cell) is not None
