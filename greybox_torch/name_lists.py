"""Names listed in a sentence."""

from __future__ import annotations

from collections.abc import Sequence

MOST_NAMES = 6
"""Names that a list in a sentence has at most."""

_START = " at the start of "


def listed(names: Sequence[str], conjunction: str = "and") -> str:
    """'a', 'a and b', 'a, b and c'."""
    return f" {conjunction} ".join([*filter(None, [", ".join(names[:-1])]), *names[-1:]])


def further(count: int, noun: str) -> str:
    """'1 more row', '2 more rows': how many were not told."""
    return f"{count} more {noun}{'' if count == 1 else 's'}"


def brief(names: Sequence[str]) -> str:
    """:func:`listed`, with the start states of several experiments as one entry, and of more than MOST_NAMES names the first."""
    states: dict[str, list[str]] = {}
    for name in names:
        state, _, _ = name.partition(_START)
        states.setdefault(state if _START in name else name, []).append(name)
    entries = [
        f"{state}{_START}{len(of)} experiments" if len(of) > 2 else entry
        for state, of in states.items()
        for entry in (of if len(of) <= 2 else of[:1])
    ]
    if len(entries) > MOST_NAMES:
        return f"{', '.join(entries[: MOST_NAMES - 1])} and {len(entries) - MOST_NAMES + 1} more"
    return listed(entries)
