"""The errors that users meet. `str(error)` is the whole message: what is wrong, where, and what is expected instead."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any


class GreyboxError(Exception):
    """Base of every error raised on purpose by this package."""


class UserError(GreyboxError):
    """The user's input is at fault: a file, a field, an option or an argument. The command line exits with 2."""


class NothingToDo(UserError):
    """Nothing is at fault, and there is nothing to do: what was asked for is decided. The command line exits with 4, without "error:"."""


class Kind(str):
    """Words for a thing that a message does not show itself, such as "an object of type list"."""

    @staticmethod
    def of(value: object) -> Kind:
        """What kind of thing it is."""
        return Kind("None" if value is None else f"an object of type {type(value).__name__}")


class ArgumentError(UserError):
    """An argument of a public function is at fault. Python speaks of the argument, the command line of the option of the same name.

    Args:
        argument: its name.
        found: what was given.
        problem: what is expected, or why that cannot be.
        option: the name of the option, where it is not the argument's.

    Examples:
        >>> str(ArgumentError("time_limit", -1, "expected a number above 0"))
        'time_limit: found -1, expected a number above 0'
        >>> ArgumentError("time_limit", -1, "expected a number above 0").for_option()
        '--time-limit -1: expected a number above 0'
    """

    def __init__(self, argument: str, found: object, problem: str, option: str | None = None) -> None:
        shown = str(found) if isinstance(found, Kind) else repr(found)
        told = shown if argument == "found" else f"found {shown}"  # the argument of design, and not twice the word
        super().__init__(f"{argument}: {told}, {problem}")
        self.argument, self.found, self.problem = argument, found, problem
        self.option = option or argument.replace("_", "-")

    def for_option(self) -> str:
        """The message with the option's name in place of the argument's."""
        return f"--{self.option} {self.found}: {self.problem}"

    def for_position(self) -> str:
        """The message where the command line takes the argument by its position."""
        return f"{self.argument.upper()} {self.found}: {self.problem}"


def check_none(problems: Sequence[str], place: str, before_one: str = ": ") -> None:
    """Raises UserError, beginning with ``place``, where there are ``problems``: one in its line, several in a line each."""
    if len(problems) == 1:
        raise UserError(f"{place}{before_one}{problems[0]}")
    if problems:
        raise UserError(f"{place}: {len(problems)} problems:\n" + "\n".join(f"  {problem}" for problem in problems))


class NumericalError(GreyboxError):
    """The numbers failed: overflow, NaN, rank deficiency. The command line exits with 3."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """' (did you mean "…"?)' with the closest of the known names, to end a message; empty where none is close."""
    from difflib import get_close_matches

    by_lower_case = {candidate.lower(): candidate for candidate in known}
    close = get_close_matches(name.lower(), by_lower_case, n=1)
    return f' (did you mean "{by_lower_case[close[0]]}"?)' if close else ""


def quoted(value: Any) -> str:
    """A value of a file as a message shows it: as JSON, cut to 60 characters."""
    try:
        text = json.dumps(value, default=str, ensure_ascii=False)
    except (ValueError, RecursionError):  # digits without end, nested without end
        return "a value too long to show"
    return text if len(text) <= 60 else text[:59] + "…"
