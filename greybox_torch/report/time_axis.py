"""The unit of a time axis: hours and days of long records, of which nobody reads 100000 s."""

from __future__ import annotations

from dataclasses import dataclass

_HOUR, _DAY = 3600.0, 86400.0
_SEVERAL = 3.0
"""Of a unit that an axis has to be long for it."""


@dataclass(frozen=True)
class TimeUnit:
    """``seconds`` of one unit, and its ``symbol``."""

    seconds: float
    symbol: str

    @property
    def label(self) -> str:
        """Of the axis."""
        return f"time [{self.symbol}]"


def time_unit(seconds: float) -> TimeUnit:
    """The unit for an axis that is so long."""
    for one in (TimeUnit(_DAY, "d"), TimeUnit(_HOUR, "h")):
        if seconds >= _SEVERAL * one.seconds:
            return one
    return TimeUnit(1.0, "s")
