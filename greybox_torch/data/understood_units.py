"""Units that a file says, read as freely as files write them: for comparing with the card's and for drafting one."""

from __future__ import annotations

import re

from greybox_torch.data.units import USUAL, TurnOrRadian, bare, conversion, is_unit
from greybox_torch.errors import UserError

_COUNTED_FROM = re.compile(r"\s*\((?:g|a|abs|rel|gauge)\)$|(?<=bar)[ga]$|(?<=bar) (?:abs|rel|gauge)$", re.IGNORECASE)
"""Behind a unit of pressure: what it is counted from, the air around or nothing."""
_LETTER = re.compile(r"[A-Za-z]")
_LETTERS = frozenset("smhVAWNJKl")
"""Letters that stand for a unit alone; others, such as T and P, more often mean something else, C and F degrees."""


def understood(unit: str) -> str:
    """A unit as it is; where it is none, the usual one that differs in capitals alone ("Bar", "KPA") or does not say what a pressure is
    counted from ("bar(g)"); else "".
    """
    alone = _COUNTED_FROM.sub("", unit.strip())
    if alone != unit.strip() and (known := understood(alone)) and not other_quantity(known, "Pa"):
        return known  # before the registry makes bar(g) a bar times a gram
    if is_unit(unit):
        return unit
    return next((usual for usual in USUAL if usual.lower() == bare(unit).lower()), "")


def capitals_alone(found: str, given: str) -> bool:
    """Whether a file's unit differs from the card's in capitals alone, as where all of a heading is in capitals: "MM" is no megamolar.
    A usual unit ("MW") is what it is.
    """
    return found.isupper() and found not in USUAL and bare(found).lower() == bare(given).lower()


def other_quantity(one: str, other: str) -> bool:
    """Whether two units are known and certainly not of one quantity, however freely files write units."""
    if one == other or any(_LETTER.fullmatch(unit) and unit not in _LETTERS for unit in (one, other)):
        return False
    try:
        conversion(one, other, "")
    except TurnOrRadian:
        return False
    except UserError:
        return is_unit(one) and is_unit(other)
    return False
