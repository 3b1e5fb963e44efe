"""The signal that multiplies a curve."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Factor:
    """What a curve is multiplied by: a ``signal``, its ``unit``, and the ``value`` that the curve's force is given at."""

    signal: str
    unit: str
    value: float

    def as_json(self) -> dict[str, str | float]:
        """Its part of the entry `curve` of an effect."""
        return {"factor": self.signal, "factor_value": self.value, "factor_unit": self.unit}
