"""What a model declares about itself: states, inputs, outputs and parameters, each with its unit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from greybox_torch.errors import UserError


def _is_finite(value: Any) -> bool:
    try:
        return not isinstance(value, str) and math.isfinite(value)
    except (TypeError, ValueError, OverflowError):
        return False


@dataclass(frozen=True)
class State:
    """A state variable.

    ``initial`` is its start value: a number, or ``"measured"`` for the first sample of the output of the same name (where there is
    none: of the only output, else the only input, in the same unit). Every start value is estimated per experiment unless ``fixed``.
    """

    name: str
    unit: str = ""
    initial: Literal["measured"] | float = 0.0
    fixed: bool = False
    description: str = ""

    def __post_init__(self) -> None:
        if self.initial != "measured" and not _is_finite(self.initial):
            raise UserError(f"State '{self.name}': initial is {self.initial!r}, expected a number or 'measured'")


@dataclass(frozen=True)
class Input:
    """A recorded input signal of the model."""

    name: str
    unit: str = ""
    description: str = ""


@dataclass(frozen=True)
class Output:
    """A recorded output signal of the model."""

    name: str
    unit: str = ""
    description: str = ""


@dataclass(frozen=True)
class Parameter:
    """A physical parameter: value in ``unit``, optional bounds (inclusive), estimated unless ``fixed``.

    Raises:
        UserError: bounds in the wrong order, or a value outside of them.
    """

    name: str
    value: float
    unit: str = ""
    lower: float | None = None
    upper: float | None = None
    fixed: bool = False
    description: str = ""
    shrunk: bool = False
    """Held weakly towards zero: of curves that fit alike, the smaller one is meant, and physics is preferred."""

    def __post_init__(self) -> None:
        if not _is_finite(self.value) and self.value == self.value:
            raise UserError(f"Parameter '{self.name}': value is {self.value!r}, expected a finite number")
        low, high = self.bounds
        if not low < high:
            raise UserError(f"Parameter '{self.name}': lower bound {low:g} is not below upper bound {high:g}")
        if not low <= self.value <= high:
            raise UserError(
                f"Parameter '{self.name}': value {self.value:g} lies outside its bounds [{low:g}, {high:g}]; "
                "expected a value within the bounds"
            )

    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds as numbers, infinite where none is given."""
        low = float("-inf") if self.lower is None else float(self.lower)
        high = float("inf") if self.upper is None else float(self.upper)
        return low, high
