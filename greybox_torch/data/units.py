"""Conversion between units, by pint, which is imported where a card asks for it."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

from greybox_torch.errors import UserError

_PLAIN = re.compile(r"[A-Za-zµμΩ°%/·*^().²³0-9 \-]{1,40}")
_LONG_NUMBER = re.compile(r"\d{3,}|\*\*|\^\s*-?\s*\d{2,}")
_TURNS = re.compile(r"(1|U|r|tr|rev)\s*/\s*min|min\s*\^?\s*(-1|⁻¹)")
"""Turns per minute, as data loggers write them; beside angles, for a rate of anything else may be 1/min."""
_ANGLE = re.compile(r"\b(rad|deg|degree|rev|turn|mrad)\b|°")
_WRITTEN = {"°C": "degC", "°F": "degF", "°": "deg", "·": "*", "²": "^2", "³": "^3", "μ": "µ"}


def conversion(source: str, target: str, place: str) -> tuple[float, float]:
    """Factor and offset: value in `target` = factor × value in `source` + offset.

    Raises UserError, beginning with `place`, where a unit is unknown or they are not of one quantity.
    """
    import pint

    registry = _registry()
    try:
        pair = (_turns(source, target), _turns(target, source))
        units = [registry.Unit(_written(unit)) for unit in pair]
        if {"hertz" in str(unit) for unit in units} == {True, False} and any("radian" in str(unit) for unit in units):
            raise UserError(f'{place}: "{source}" and "{target}" differ by a turn; give the factor as scale')
        zero, one = (registry.Quantity(value, units[0]).to(units[1]).magnitude for value in (0.0, 1.0))
    except pint.DimensionalityError:
        raise UserError(
            f'{place}: "{source}" cannot be converted to "{target}"; expected units of one quantity'
        ) from None
    except UserError:
        raise
    except Exception as error:  # pint's parser raises what its tokenizer does
        raise UserError(
            f'{place}: cannot convert "{source:.40}" to "{target:.40}": {" ".join(str(error).split()):.100}; '
            'expected units such as "deg/s", "rpm" or "N cm", or a scale'
        ) from None
    return float(one - zero), float(zero)


def slip(found: str, given: str) -> float | None:
    """The factor from the unit that a file says to the one that a card says, where both are known and the factor is not 1."""
    try:
        factor, offset = conversion(found, given, "")
    except UserError:
        return None
    return None if abs(factor - 1.0) < 1e-9 and offset == 0.0 else factor


def dimensionality(unit: str) -> dict[str, float]:
    """Powers of the base quantities ("[length]", "[time]", …) in a unit; none for an angle.

    Raises ValueError where it is no unit.
    """
    try:
        return {str(name): float(power) for name, power in _registry().Unit(_written(unit)).dimensionality.items()}
    except Exception as error:  # pint's parser raises what its tokenizer does
        raise ValueError(f'"{unit:.40}" is not a unit') from error


def per_minute(unit: str) -> bool:
    """Whether a unit may be turns per minute, as data loggers write it."""
    return bool(_TURNS.fullmatch(unit.strip("[]() ")))


def _turns(unit: str, other: str) -> str:
    """Turns per minute where that is meant: "1/min" beside an angle."""
    return "rpm" if per_minute(unit) and _ANGLE.search(other) else unit


def _written(unit: str) -> str:
    if not _PLAIN.fullmatch(unit) or _LONG_NUMBER.search(unit):
        raise ValueError("not a unit")
    for sign, word in _WRITTEN.items():
        unit = unit.replace(sign, word)
    return unit


@cache
def _registry() -> Any:
    import pint

    registry = pint.UnitRegistry()
    registry.define("rev = turn")
    registry.define("Nm = newton * meter")
    registry.define("Ohm = ohm")
    return registry
