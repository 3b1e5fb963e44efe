"""Which units name an angle: of one there is no dimension, and 1/s may be rad/s."""

from __future__ import annotations

import re

_ANGLE = re.compile(r"\b(rad|deg|degrees?|rev|revolutions?|turns?|cycles?|mrad|rps)\b|rpm\b|°(?!\s*[CF])")


def has_angle(unit: str) -> bool:
    """Whether an angle is part of a unit: of "rad", "°/s", "rpm" and "N m s/rad", not of "1/s", "Hz" or "degC"."""
    return _ANGLE.search(unit) is not None
