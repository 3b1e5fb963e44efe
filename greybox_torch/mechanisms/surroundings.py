"""What a mechanism may know of the place it is attached to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from greybox_torch.model.unit_of_rate import unit_of_rate


@dataclass(frozen=True)
class Range:
    """Where a signal moved in the recordings: lowest and highest value, and root mean square, in its unit."""

    low: float
    high: float
    rms: float

    @property
    def reach(self) -> float:
        """The largest magnitude, never zero."""
        return max(abs(self.low), abs(self.high), 1e-12)

    @property
    def span(self) -> float:
        """From the lowest to the highest value, never zero."""
        return max(self.high - self.low, 1e-9 * self.reach)


@dataclass(frozen=True)
class Surroundings:
    """What a mechanism may know of the place it is attached to, to choose sensible ranges.

    ``ranges`` and ``units`` by signal name (``speed``, ``position``, ``load``, ``time``, ``deflection``, ``rate``, ``level``, ``input``,
    ``output``); ``force_unit`` of the port; ``sample_time`` in s. ``unmeasured``: signals whose range is that of a model which lacks what
    is looked for, as no sensor shows them. ``excited``: the angular frequency in rad/s up to which the inputs have most of their power.
    ``passed_once``: signals that are nowhere twice within an experiment. ``timed``: whether anything says when an output should have moved,
    an input that moves within an experiment or a second output.
    """

    ranges: Mapping[str, Range]
    units: Mapping[str, str]
    force_unit: str
    sample_time: float
    unmeasured: frozenset[str] = frozenset()
    excited: float = float("inf")
    passed_once: frozenset[str] = frozenset()
    timed: bool = True

    def per(self, signal: str, power: int = 1) -> str:
        """The unit of force per signal to a power; empty where that of the force is not known."""
        unit = self.units.get(signal, "")
        if not unit or not self.force_unit:
            return self.force_unit
        if power == 1 and self.force_unit == (rate := unit_of_rate(unit)):
            return "1/s"
        if power == 1 and self.force_unit == unit_of_rate(rate):
            return "1/s^2"
        return f"{self.force_unit}/({unit})" + (f"^{power}" if power > 1 else "")
