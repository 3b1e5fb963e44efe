"""The unit of how fast something changes."""

from __future__ import annotations


def unit_of_rate(unit: str) -> str:
    """The unit of the rate of a state of this unit; empty where that is not known."""
    if not unit:
        return ""
    return f"{unit.removesuffix('/s')}/s^2" if unit.endswith("/s") else f"{unit}/s"
