"""A field of the settings: its default, what it means, its unit, what it was chosen by, and which values it may have."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

from greybox_torch.errors import UserError
from greybox_torch.estimate.levenberg_marquardt import Settings

CASES = "the development cases"
"""Why most thresholds are what they are: the cases with concealed effects on which the diagnosis was developed come out right with them."""

SIGMA = "standard errors"


@dataclass(frozen=True)
class About:
    """Of one field: what it means, in which unit, what its default was chosen by, and the bounds of its values (inclusive).

    ``kind`` is "number", "integer", "integers" (several of them) or "iteration" (the limits of a Levenberg-Marquardt iteration).
    """

    meaning: str
    unit: str
    chosen_by: str
    least: float
    most: float
    kind: str = "number"


def number(
    default: float, meaning: str, *, unit: str, chosen_by: str = CASES, least: float = 0.0, most: float = math.inf
) -> Any:
    """A field for a number."""
    return _field(default, About(meaning, unit, chosen_by, least, most))


def share(default: float, meaning: str, *, unit: str = "share", chosen_by: str = CASES) -> Any:
    """A field for a number between zero and one."""
    return _field(default, About(meaning, unit, chosen_by, 0.0, 1.0))


def ratio(default: float, meaning: str, *, unit: str, chosen_by: str = CASES) -> Any:
    """A field for a factor of at least one."""
    return _field(default, About(meaning, unit, chosen_by, 1.0, math.inf))


def count(default: int, meaning: str, *, unit: str = "", chosen_by: str = CASES, least: int = 1) -> Any:
    """A field for a whole number."""
    return _field(default, About(meaning, unit, chosen_by, least, math.inf, "integer"))


def counts(default: tuple[int, ...], meaning: str, *, unit: str = "", chosen_by: str = CASES, least: float = 1) -> Any:
    """A field for several whole numbers."""
    return _field(default, About(meaning, unit, chosen_by, least, math.inf, "integers"))


def iteration(default: Settings, meaning: str, *, chosen_by: str = CASES) -> Any:
    """A field for the limits of a Levenberg-Marquardt iteration."""
    unit = "iterations, relative change of the cost, trial steps, damping to begin with"
    return _field(default, About(meaning, unit, chosen_by, 0.0, math.inf, "iteration"))


def about(field: dataclasses.Field[Any]) -> About:
    """What is known of a field made by this module."""
    found = field.metadata["about"]
    assert isinstance(found, About)
    return found


def check(instance: Any) -> None:
    """Every field of a settings object within its bounds, and of its kind.

    Raises:
        UserError: one is not; the message names the field, what was found and what is expected.
    """
    for field in dataclasses.fields(instance):
        wrong = complaint(about(field), getattr(instance, field.name))
        if wrong:
            raise UserError(f"{type(instance).__name__}: {field.name}: {wrong}")


def complaint(what: About, value: Any) -> str:
    """What is wrong with a value for a field, and what is expected; empty where nothing is."""
    if what.kind == "iteration":
        return _iteration_complaint(value)
    several = what.kind == "integers"
    if several and not (isinstance(value, tuple) and value):
        return f"found {value!r}; expected a list of integers"
    for each in value if several else (value,):
        kinds = (int,) if what.kind in ("integer", "integers") else (int, float)
        if isinstance(each, bool) or not isinstance(each, kinds) or not what.least <= each <= what.most:
            return f"found {each!r}; expected {_expected(what)}"
    return ""


def _field(default: Any, what: About) -> Any:
    return dataclasses.field(default=default, metadata={"about": what})


def _expected(what: About) -> str:
    noun = "a number" if what.kind == "number" else "an integer"
    unit = f" ({what.unit})" if what.unit else ""
    if math.isfinite(what.most):
        return f"{noun} from {what.least:g} to {what.most:g}{unit}"
    return f"{noun} of at least {what.least:g}{unit}" if math.isfinite(what.least) else f"{noun}{unit}"


def _iteration_complaint(value: Any) -> str:
    if not isinstance(value, Settings):
        return f"found {value!r}; expected the limits of an iteration: iterations, tolerance, trials, damping"
    for name, least in (("iterations", 1), ("trials", 1)):
        found = getattr(value, name)
        if isinstance(found, bool) or not isinstance(found, int) or found < least:
            return f"{name}: found {found!r}; expected an integer of at least {least}"
    for name in ("tolerance", "damping"):
        found = getattr(value, name)
        if isinstance(found, bool) or not isinstance(found, int | float) or not 0.0 < found < math.inf:
            return f"{name}: found {found!r}; expected a number above zero"
    return ""
