"""The unit of how fast something changes, and of what that comes to over time."""

from __future__ import annotations

_NONE = {"-", "–", "1"}
"""How a number without a unit is declared."""

_RATES = {"/s^2": "/s", "/s²": "/s", "/s2": "/s", " s^-2": " s^-1", " s-2": " s-1", "/s": "", " s^-1": "", " s-1": ""}
"""How units of rates end, and what is left of that in the unit of the integral."""


def unit_of_rate(unit: str) -> str:
    """The unit of the rate of a state of this unit; empty where that is not known."""
    if not unit:
        return ""
    return f"{unit.removesuffix('/s')}/s^2" if unit.endswith("/s") else f"{unit}/s"


def unit_of_integral(unit: str) -> str:
    """The unit of the integral over time of a signal of this unit; empty where that is not known."""
    if not unit or unit in _NONE:
        return "s" if unit else ""
    for rate, left in _RATES.items():
        if unit.endswith(rate):
            return unit.removesuffix(rate).rstrip() + left
    return f"{unit} s"
