"""Templates with places to fill in, `{{ NAME }}`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

_TEMPLATES = Path(__file__).parent / "templates"
_PLACE = re.compile(r"\{\{ (\w+) \}\}")


def filled(template: str, places: Mapping[str, object]) -> str:
    """The template file of that name with its places filled in; a place without a value is a KeyError."""
    text = (_TEMPLATES / f"{template}.txt").read_text(encoding="utf-8")
    return _PLACE.sub(lambda place: str(places[place[1]]), text)
