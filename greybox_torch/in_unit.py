"""A number with its unit, in a sentence."""

from __future__ import annotations


def in_unit(number: str, unit: str) -> str:
    """The number with its unit behind it, if it has one: "1" is that of plain numbers, and reads as part of the number.

    Examples:
        >>> in_unit("0.251", "rad"), in_unit("0.251", "1"), in_unit("0.251", "")
        ('0.251 rad', '0.251', '0.251')
    """
    return f"{number} {unit}" if unit not in ("", "1") else number
