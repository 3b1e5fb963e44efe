"""Arguments of the public functions that need no model to be checked: without torch, which takes a second to load."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable
from numbers import Integral, Real
from typing import Any, TypeVar

from greybox_torch.errors import ArgumentError, Kind

Settings = TypeVar("Settings")
Told = TypeVar("Told")


def check_device(device: str) -> str:
    """The device as torch names it. Raises ArgumentError where torch does not know it or this machine does not have it."""
    if device == "cpu":
        return device
    import torch  # which takes a second to load

    try:
        known = torch.device(device)
    except (RuntimeError, TypeError):
        known = None
    if known is None or known.type not in ("cpu", "cuda"):
        raise ArgumentError("device", device, 'expected "cpu", "cuda" or "cuda:N"')
    if known.type == "cpu":
        return "cpu"
    count = torch.cuda.device_count() if torch.cuda.is_available() else 0
    if (known.index or 0) >= count:
        have = f"{count} CUDA device{'s' * (count != 1)}" if count else "no CUDA device that torch can use"
        raise ArgumentError("device", device, f"this machine has {have}")
    return str(known)


def check_whole(argument: str, value: Any, low: int, high: int) -> int:
    """``value``, which may be one of NumPy's. Raises ArgumentError where it is not a whole number from ``low`` to ``high``."""
    if isinstance(value, bool) or not isinstance(value, Integral) or not low <= int(value) <= high:
        raise ArgumentError(argument, value, f"expected a whole number from {low} to {high}")
    return int(value)


def check_seconds(argument: str, value: Any) -> float:
    """``value``, which may be one of NumPy's. Raises ArgumentError where it is not a finite number above zero."""
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 < float(value) < math.inf:
        raise ArgumentError(argument, value, "expected a number above 0")
    return float(value)


def check_seed(seed: Any) -> int:
    """Raises ArgumentError where ``seed`` cannot be one."""
    return check_whole("seed", seed, 0, 2**32 - 1)


def check_names(argument: str, names: Iterable[str]) -> tuple[str, ...]:
    """The names, each once. Raises ArgumentError for a text, which would be taken letter by letter."""
    if isinstance(names, str):
        raise ArgumentError(argument, names, f'expected a list of names, such as ["{names}"]')
    return tuple(dict.fromkeys(names))


def check_told(argument: str, value: Told, what: str = "a text") -> Told:
    """A function that is told of progress. Raises ArgumentError where ``value`` is none; ``what`` it is called with."""
    if not callable(value):
        raise ArgumentError(argument, value, f"expected a function that is called with {what}; leave it out for none")
    if not _called_with_one(value):
        raise ArgumentError(argument, Kind(_signature(value)), f"expected a function that is called with {what} alone")
    return value


def _called_with_one(value: Callable[..., object]) -> bool:
    """Whether it can be called with one argument by position; taken to be so where Python does not know its parameters."""
    try:
        parameters = inspect.signature(value)
    except (TypeError, ValueError):
        return True
    try:
        parameters.bind(None)
    except TypeError:
        return False
    return True


def _signature(value: Callable[..., object]) -> str:
    """A function as a message shows it, such as "lambda()"."""
    return f"{getattr(value, '__name__', type(value).__name__).strip('<>')}{inspect.signature(value)}"


def check_kind(argument: str, value: Settings, kind: type[Settings]) -> Settings:
    """Raises ArgumentError where ``value`` is not of the class ``kind``."""
    if not isinstance(value, kind):
        raise ArgumentError(argument, Kind.of(value), f"expected {kind.__name__}(…)")
    return value
