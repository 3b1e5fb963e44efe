"""The signal that multiplies a curve."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Factor:
    """What a curve is multiplied by: a ``signal``, its ``unit``, and the ``value`` that the curve's force is given at."""

    signal: str
    unit: str
    value: float
