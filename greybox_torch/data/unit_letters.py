"""Names of units that begin with a capital, as in "W/Kelvin", which no registry knows."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any


def in_small_letters(unit: str, parsed: Callable[[str], Any]) -> str:
    """The symbols of a unit that is none but with its names in small letters, to end a message; else "".

    Args:
        parsed: makes pint's unit of a text, or raises.
    """
    small = re.sub(r"[A-Za-z]{4,}", lambda word: word[0].lower(), unit)
    if small == unit:
        return ""
    try:
        symbols = f"{parsed(small):~C}"
    except Exception:  # pint's parser raises what its tokenizer does
        return ""
    return f' (did you mean "{symbols.replace("**", "^").replace("*", " ")}"?)'
