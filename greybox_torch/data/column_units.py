"""Units that stand in the name of a column: "speed [rpm]", "angle (deg)", "torque_Nm"."""

from __future__ import annotations

import re

from greybox_torch.data.units import is_unit

_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]{1,20})\s*[\])]\s*$")
_ENDINGS = {
    "rpm": "rpm", "deg": "deg", "degs": "deg/s", "dps": "deg/s", "rad": "rad", "rads": "rad/s", "radps": "rad/s", "nm": "N m",
    "mnm": "mN m", "mm": "mm", "ma": "mA", "mv": "mV", "bar": "bar", "degc": "degC", "°c": "degC", "degf": "degF", "°f": "degF", "kw": "kW",
    "kn": "kN", "knm": "kN m", "mrad": "mrad", "cm": "cm", "km": "km", "um": "um", "µm": "um", "kg": "kg", "ms": "ms", "us": "us",
    "kv": "kV", "kj": "kJ", "hz": "Hz", "khz": "kHz", "hpa": "hPa", "kpa": "kPa", "mpa": "MPa", "mbar": "mbar",
    "kmh": "km/h", "kph": "km/h",
}  # fmt: skip
_GLUED = re.compile(r"([uyUY])([A-Za-z]{2,4})")
"""An input or output by its letter, and perhaps its unit: yrad beside y, which holds counts."""
_AS_WRITTEN = ("mN", "MN", "mW", "MW", "mJ", "MJ", "Pa")
"""Units of which small letters would be another one, or no unit. A letter alone is none: x_m was measured, F_N is normal to something."""


def unit_in(column: str) -> str:
    """The unit; empty where none can be read."""
    bracketed = _BRACKETS.search(column)
    if bracketed and is_unit(bracketed[1]) and not bracketed[1].isdigit():
        return bracketed[1]
    if glued := _GLUED.fullmatch(column):
        return _ENDINGS.get(glued[2].lower(), "")
    _, underscore, last = column.rpartition("_")
    if not underscore:
        return ""
    return last if last in _AS_WRITTEN else _ENDINGS.get(last.lower(), "")


def without_unit(column: str) -> str:
    """The name without the brackets at its end."""
    bracketed = _BRACKETS.search(column)
    return column[: bracketed.start()].strip() if bracketed and unit_in(column) else column


def without_ending(column: str) -> str:
    """The name without its unit, in brackets or behind the last underscore."""
    bare = without_unit(column)
    if (glued := _GLUED.fullmatch(column)) and unit_in(column):
        return glued[1]
    return column.rpartition("_")[0] if bare == column and unit_in(column) and "_" in column[1:] else bare
