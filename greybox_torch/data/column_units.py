"""Units that stand in the name of a column: "speed [rpm]", "angle (deg)", "torque_Nm", "stroke/mm", "current in A"."""

from __future__ import annotations

import re

from greybox_torch.data.units import USUAL, is_unit, turns_per_time

_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]{1,20})\s*[\])]\s*$")
_IN = re.compile(r"(?<=\S)\s+in\s+([^\s\[\]()][^\[\]()]{0,19})$")
_OVER = re.compile(r"(?<=[^\s/])\s*/\s*(\S{1,20})$")
"""A quantity over its unit, as DIN 1313 has it; further slashes are the unit's."""
_ENDINGS = {
    "rpm": "rpm", "deg": "deg", "degs": "deg/s", "dps": "deg/s", "rad": "rad", "rads": "rad/s", "radps": "rad/s", "nm": "N m",
    "mnm": "mN m", "mm": "mm", "ma": "mA", "mv": "mV", "bar": "bar", "degc": "degC", "°c": "degC", "degf": "degF", "°f": "degF", "kw": "kW",
    "kn": "kN", "knm": "kN m", "mrad": "mrad", "cm": "cm", "km": "km", "um": "um", "µm": "um", "kg": "kg", "ms": "ms", "us": "us",
    "kv": "kV", "kj": "kJ", "hz": "Hz", "khz": "kHz", "hpa": "hPa", "kpa": "kPa", "mpa": "MPa", "mbar": "mbar",
    "kmh": "km/h", "kph": "km/h", "gpm": "gpm", "lpm": "l/min",
}  # fmt: skip
_GLUED = re.compile(r"([uyUY])([A-Za-z]{2,4})")
"""An input or output by its letter, and perhaps its unit: yrad beside y, which holds counts."""
_AS_WRITTEN = ("mN", "MN", "mW", "MW", "mJ", "MJ", "Pa")
"""Units of which small letters would be another one, or no unit. A letter alone is none: x_m was measured, F_N is normal to something."""


_OVER_ONE = {
    *_AS_WRITTEN,
    *(unit for unit in _ENDINGS.values() if unit not in ("ms", "us")),
    *(unit for unit in USUAL if len(unit) > 1 and unit not in ("min", "ms")),
    "°C",
    "°F",
    "m/s²",
    "m³/h",
    "Nm",
    "kNm",
}
"""Units that a quantity stands over; letters alone are the names of signals in paths as well ("motor/A"), and per minute is a rate
("strokes/min")."""
OF_QUANTITY = {
    "A": re.compile(r"(i|i[dq]|curr?|currents?|amps?|strom)([\W_\d]|$)", re.IGNORECASE),
    "V": re.compile(r"(u|v|u[dq]|volts?|voltages?|spannung)([\W_\d]|$)", re.IGNORECASE),
}
"""What a name begins with where a letter at its end is a unit, and no phase."""
_PARTS = re.compile(r"(.+)([_/]|(?<=\S) )([^_/ ]+)")
"""A name, what stands before its last word, and that word, which may be a unit."""


def unit_in(column: str) -> str:
    """The unit; empty where none can be read."""
    if set_apart := _set_apart(column):
        return set_apart[1]
    if glued := _GLUED.fullmatch(column):
        return _ENDINGS.get(glued[2].lower(), "")
    _, _, last = parts_of(column)
    return last if last in _AS_WRITTEN else _ENDINGS.get(last.lower(), "")


def is_set_apart(column: str) -> bool:
    """Whether the unit stands where nothing but a unit does: in brackets, behind "in", or below the quantity."""
    return _set_apart(column) is not None


def parts_of(column: str) -> tuple[str, str, str]:
    """The name, the "_", "/" or space before its last word, and that word; "" where it is one word. A path begins with a slash."""
    found = None if column.startswith("/") else _PARTS.fullmatch(column)
    return (found[1], found[2], found[3]) if found else (column, "", "")


def _set_apart(column: str) -> re.Match[str] | None:
    behind_in = _IN.search(column)
    if behind_in and len(behind_in[1]) == 1 and not _names_its_quantity(column, behind_in[1]):
        return None  # the pressure in chamber A
    bracketed = _BRACKETS.search(column) or behind_in
    if bracketed:
        return bracketed if not bracketed[1].isdigit() and is_unit(bracketed[1]) else None
    over = None if "/" not in column or column.startswith("/") else _OVER.search(column, column.index("/") - 1)
    usual = over is not None and (over[1] in _OVER_ONE or turns_per_time(over[1]))
    return over if usual and not (turns_per_time(column) or is_unit(column)) else None


def _names_its_quantity(column: str, unit: str) -> bool:
    return unit in OF_QUANTITY and bool(OF_QUANTITY[unit].match(column))


def without_unit(column: str) -> str:
    """The name without the unit that is set apart at its end."""
    set_apart = _set_apart(column)
    return column[: set_apart.start()].rstrip("/ ").lstrip() if set_apart else column


def without_ending(column: str) -> str:
    """The name without its unit, which is set apart or its last word."""
    bare = without_unit(column)
    if (glued := _GLUED.fullmatch(column)) and unit_in(column):
        return glued[1]
    return parts_of(column)[0] if bare == column and unit_in(column) else bare
