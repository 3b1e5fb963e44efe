"""What an order over a travel comes to: the distance in which a ripple repeats."""

from __future__ import annotations

import math

OF_TRAVEL = "rad/"
"""What the unit of an order begins with where positions are no angles."""

TOLD = "radians per travel: 2 pi over the pitch"


def order_told(unit_of_position: str) -> tuple[str, str]:
    """The unit of an order over a position of this unit, and what it is.

    A position in rad, or of no known unit, is an angle: its order counts periods per turn.
    """
    if unit_of_position in ("rad", ""):
        return "", "periods per turn"
    compound = not unit_of_position.isalpha()
    return f"{OF_TRAVEL}({unit_of_position})" if compound else f"{OF_TRAVEL}{unit_of_position}", TOLD


def pitch_of(order: float, unit: str, deviation: float | None = None) -> tuple[float, float | None, str] | None:
    """The pitch 2π/order, its standard deviation and their unit, from an ``order`` in ``unit``; None where that is one of an angle.

    Metres are given in mm below one, as pitches of motors and screws are.
    """
    if not unit.startswith(OF_TRAVEL) or not order:
        return None
    length = unit.removeprefix(OF_TRAVEL).strip("()")
    pitch = 2 * math.pi / abs(order)
    scale, length = (1e3, "mm") if length == "m" and pitch < 1.0 else (1.0, length)
    return scale * pitch, None if deviation is None else scale * pitch * deviation / abs(order), length


def with_pitch(description: str, order: float, unit: str) -> str:
    """The ``description`` of a parameter, with the pitch that its value comes to where it is an order over a travel."""
    found = pitch_of(order, unit) if description == TOLD else None
    return description if found is None else f"{description}, here {found[0]:.4g} {found[2]}"
