"""Conversion between units, by pint, which is imported where a card asks for it."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Any

from greybox_torch.data.angles import has_angle
from greybox_torch.data.gallons import FLOWS, with_gallons
from greybox_torch.data.unit_letters import in_small_letters
from greybox_torch.errors import UserError, did_you_mean

_PLAIN = re.compile(r"[A-Za-zµμΩ°%/·*^().²³0-9 \-]{1,40}")
_LONG_NUMBER = re.compile(r"\d{3,}|\*\*|\^\s*-?\s*\d{2,}")
_FACTOR = re.compile(r"\s*(\d[\d.]*\s*(?:[eE]\s*[-+]?\d+|\^\s*-?\d+|[*·x]\s*10\s*\^\s*-?\d+)?)\s*[*·]?\s*(.*?)\s*")
_ONE = re.compile(r"1(\.0*)?")
_TURNS = re.compile(r"(1(?:\.0*)?|U|r|tr|rev)\s*/\s*min|min\s*\^?\s*(-1|⁻¹)")
"""Turns per minute, as data loggers write them; beside angles and turns, for a rate of anything else may be 1/min."""
_NAMED_TURNS = re.compile(r"^\W*(?:U|r|tr|rev)\s*/\s*(min|s)\b\W*(?=$|/)")
_RATE = " / s"
_WRITTEN = {"°C": "degC", "°F": "degF", "°": "deg", "·": "*", "²": "^2", "³": "^3", "μ": "µ"}
_POWER = re.compile(r"(?<=[A-Za-zµ])(-?[1-4])(?![\w.])")
"""A power without its sign: the 2 of m/s2, the -1 of rad s-1; not that of mH2O."""
USUAL = (
    "rpm", "rad/s", "deg/s", "rev/s", "rad", "deg", "degC", "degF", "K", "Hz", "kHz", "W", "kW", "MW", "J", "kJ", "N", "kN", "N m", "kN m",
    "Pa", "hPa", "kPa", "MPa", "bar", "mbar", "psi", "V", "mV", "kV", "A", "mA", "ohm", "m", "mm", "cm", "km", "m/s", "mm/s", "km/h",
    "m/s^2", "kg", "s", "ms", "min", "h", "l/min", "m^3/h", "m^3/s", "lpm", "gpm", "l", "%",
)  # fmt: skip
"""What may be meant by a unit that is none, or one of another quantity but for its capitals."""
_DEGREES = re.compile(r"deg\s+([CF])\b")
"""Temperatures as loggers write them; the registry would take degrees times coulombs."""
_GRAVITY = {"g": "gram", "mg": "milligram", "G": "gauss"}
"""How accelerometers write multiples of gravity, and what that is beside other quantities."""


class TurnOrRadian(UserError):
    """One unit counts turns or says nothing of what it counts, the other counts turns or angles: the factor may be 2 pi or 1."""


def conversion(source: str, target: str, place: str) -> tuple[float, float]:
    """Factor and offset: value in `target` = factor × value in `source` + offset.

    A hertz beside turns is a turn per second; a "g" beside an acceleration one of gravity. Raises UserError, beginning with `place`, where
    a unit is unknown or they are not of one quantity, and TurnOrRadian where they are but nobody can tell the factor: hertz beside rad/s,
    1/s beside rpm.
    """
    import pint

    registry = _registry()
    try:
        pair = (_as_meant(source, target), _as_meant(target, source))
        units = [registry.Unit(_written(unit)) for unit in pair]
        of_hertz = _hertz_in_turns(source, target, units, place)
        zero, one = (registry.Quantity(value, units[0]).to(units[1]).magnitude for value in (0.0, 1.0))
    except pint.DimensionalityError:
        hint = meant(source, target, capitals=True) if place else ""
        raise UserError(
            f'{place}: "{source}" cannot be converted to "{target}"{hint}; expected units of one quantity'
        ) from None
    except UserError:
        raise
    except Exception as error:  # pint's parser raises what its tokenizer does
        hint = (meant(source, target) or meant(target, source)) if place else ""
        unknown = [f'"{unit:.40}"' for unit in (source, target) if not is_unit(unit)]
        why = f"{' and '.join(unknown)} is no unit that is known" if unknown else f"{' '.join(str(error).split()):.100}"
        usual = usual_units(target if is_unit(target) else source) or ("deg/s", "rpm", "N cm")
        such = ", ".join(f'"{unit}"' for unit in usual)
        raise UserError(
            f'{place}: cannot convert "{source:.40}" to "{target:.40}": {why}{hint}; expected units such as {such}, or a scale'
        ) from None
    return float(one - zero) * of_hertz, float(zero)


def _hertz_in_turns(source: str, target: str, units: list[Any], place: str) -> float:
    """What a factor by pint, to which a hertz is a radian per second, is to be multiplied with."""
    kinds = [_counted(unit) for unit in units]
    if units[0].dimensionality != units[1].dimensionality or set(units[0].dimensionality) != {"[time]"}:
        return 1.0
    if set(kinds) == {"hertz", "angle"}:
        raise TurnOrRadian(f'{place}: "{source}" and "{target}" differ by a turn; give the factor as scale')
    if set(kinds) == {"", "turns"}:
        bare, turns = (source, target) if kinds[1] else (target, source)
        raise TurnOrRadian(
            f'{place}: "{bare}" beside "{turns}" may count turns or radians; expected a unit that says which, such as "rev/s" or "rad/s", '
            "or the factor as scale"
        )
    return {("hertz", "turns"): 2 * math.pi, ("turns", "hertz"): 0.5 / math.pi}.get((kinds[0], kinds[1]), 1.0)


def _counted(unit: Any) -> str:
    """What a frequency or an angular speed counts: turns, angle, hertz, or nothing that it says."""
    words = {"turn": "turns", "rev": "turns", "radian": "angle", "degree": "angle", "hertz": "hertz"}
    return next((kind for word, kind in words.items() if word in str(unit)), "")


def meant(unit: str, other: str, *, capitals: bool = False) -> str:
    """A usual unit of the quantity of `other`, to end a message about `unit`; with `capitals`, one that differs in them alone."""
    if not capitals and _dimension(unit) is not None:
        return ""
    quantity = _dimension(other)
    near = [usual for usual in USUAL if quantity is None or _dimension(usual) == quantity]
    return did_you_mean(unit, [usual for usual in near if not capitals or usual.lower() == unit.lower()])


def usual_units(unit: str) -> tuple[str, ...]:
    """Usual units of the quantity of ``unit``, the plain number left out; none where it is no unit that is known."""
    quantity = _dimension(unit)
    return tuple(usual for usual in USUAL if quantity and _dimension(usual) == quantity)


def gravity(one: str, other: str) -> str:
    """To go on in a message about two units of which one is a mass here and gravity to those who write it, and the other an acceleration;
    "" elsewhere.
    """
    names = [bare(unit) for unit, beside in ((one, other), (other, one)) if _dimension(beside) == _dimension("m/s^2")]
    name = next((name for name in names if name in _GRAVITY), "")
    if not name:
        return ""
    ours = "mg0" if name == "mg" else "g0"
    factor = 1e-3 if name == "mg" else 1.0
    return f' ("{name}" is the {_GRAVITY[name]}; multiples of gravity are "{ours}", {factor * 9.80665:g} m/s^2 each)'


def written_alike(one: str, other: str) -> bool:
    """Whether two units are one but for the freedom in writing it: spaces, signs, and capitals where these make no other unit."""
    if one == other:
        return True  # without the unit registry, which takes its time to load
    spelt = [bare(unit) for unit in (one, other)]
    if spelt[0].lower() != spelt[1].lower():
        return False
    dimensions = [_dimension(unit) for unit in (one, other)]
    if None not in dimensions and dimensions[0] != dimensions[1]:  # "m s" and "ms", "A" and "a"
        return False
    return spelt[0] == spelt[1] or slip(one, other) is None


def bare(unit: str) -> str:
    """A unit without the freedom in writing it, for comparing alone: "m2" as "m^2", "A·s" and "A s" as "As"."""
    return _spelt(unit).replace("*", " ").replace(" ", "")


def slip(found: str, given: str) -> float | None:
    """The factor from the unit that a file says to the one that a card says, where both are known and the factor is not 1.

    NaN where nobody can tell it, see TurnOrRadian. None for the plain number that a file may say of an angle.
    """
    if found == "1" and has_angle(_spelt(given)):
        return None
    try:
        factor, offset = conversion(found, given, "")
    except TurnOrRadian:
        return math.nan
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
        small = in_small_letters(unit, lambda text: _registry().Unit(_written(text)))
        why = ": it begins with a number" if factor_in(unit) else small
        raise ValueError(f'"{unit:.40}" is not a unit{why}') from error


def factor_in(unit: str) -> tuple[str, str] | None:
    """The number that a unit begins with and the unit behind it, where that is more than the 1 of "1/s": "1e6" and "kg m^2"."""
    found = _FACTOR.fullmatch(unit)
    return (found[1].strip(), found[2]) if found and not _ONE.fullmatch(found[1].strip()) else None


def is_unit(text: str) -> bool:
    """Whether a text is a unit that is known."""
    return _dimension(text) is not None


def per_minute(unit: str) -> bool:
    """Whether a unit may be turns per minute, as data loggers write it."""
    return bool(_TURNS.fullmatch(unit.strip("[]() ")))


def turns_per_time(unit: str) -> bool:
    """Whether a unit counts turns by their name: "U/min", "rev/s"."""
    return bool(_NAMED_TURNS.fullmatch(unit))


def in_base_units(unit: str) -> float | None:
    """What a difference of one in a unit is in base units of the SI; None where it is not known."""
    try:
        zero, one = (_registry().Quantity(value, _written(unit)).to_base_units() for value in (0.0, 1.0))
    except Exception:  # pint's parser raises what its tokenizer does
        return None
    return float(one.magnitude - zero.magnitude)


def _as_meant(unit: str, other: str) -> str:
    """Gravity where "g" is meant as that, beside an acceleration; turns per minute where "1/min" is, beside an angle or turns."""
    plain = bare(unit.strip("[]() "))
    if plain in _GRAVITY and _dimension(other) == _dimension("m/s^2"):
        return "mg0" if plain == "mg" else "g0"
    plain = unit.removesuffix(_RATE)
    return "rpm" + unit[len(plain) :] if per_minute(plain) and has_angle(_spelt(other)) else unit


def _dimension(unit: str) -> dict[str, float] | None:
    try:
        return dimensionality(unit)
    except ValueError:
        return None


def _written(unit: str) -> str:
    unit = unit.replace("g_n", "gn")
    if factor_in(unit):  # of 1e-3 the registry makes a power of the elementary charge
        raise ValueError("a unit does not begin with a number")
    if not _PLAIN.fullmatch(unit) or _LONG_NUMBER.search(unit):
        raise ValueError("not a unit")
    return _spelt(unit)


def _spelt(unit: str) -> str:
    """A unit as pint writes it."""
    unit = _NAMED_TURNS.sub(lambda turns: {"min": "rpm", "s": "rps"}[turns[1]], with_gallons(unit))
    for sign, word in _WRITTEN.items():
        unit = unit.replace(sign, word)
    return _POWER.sub(r"^\1", _DEGREES.sub(r"deg\1", unit))


@cache
def _registry() -> Any:
    import pint

    registry = pint.UnitRegistry()
    registry.define("rev = turn")
    registry.define("dps = degree / second")
    registry.define("Nm = newton * meter")
    registry.define("Ncm = newton * centimeter")
    registry.define("Nmm = newton * millimeter")
    registry.define("Ohm = ohm")
    for flow in ("lpm = liter / minute", *FLOWS):
        registry.define(flow)
    registry.define("gn = standard_gravity")
    return registry
