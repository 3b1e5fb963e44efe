"""The errors that users meet. `str(error)` is the whole message: what is wrong, where, and what is expected instead."""

from __future__ import annotations

from collections.abc import Iterable


class GreyboxError(Exception):
    """Base of every error raised on purpose by this package."""


class UserError(GreyboxError):
    """The user's input is at fault: a file, a field, an option or an argument. The command line exits with 2."""


class NumericalError(GreyboxError):
    """The numbers failed: overflow, NaN, rank deficiency. The command line exits with 3."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """' (did you mean "…"?)' with the closest of the known names, to end a message; empty where none is close."""
    from difflib import get_close_matches

    by_lower_case = {candidate.lower(): candidate for candidate in known}
    close = get_close_matches(name.lower(), by_lower_case, n=1)
    return f' (did you mean "{by_lower_case[close[0]]}"?)' if close else ""
