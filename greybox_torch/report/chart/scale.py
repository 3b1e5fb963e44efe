"""Axes: where a value lies, and which values are marked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


_TURNS = (15.0, 30.0, 45.0, 90.0, 180.0, 360.0)
_LEAST_TURN = 45.0  # degrees from which they are told in parts of a turn


@dataclass(frozen=True)
class Tick:
    """A mark at ``place`` (0 at the low end of the axis, 1 at the high end) with its label."""

    place: float
    label: str


@dataclass(frozen=True)
class Scale:
    """An axis from ``low`` to ``high``, linear or logarithmic (then both are positive)."""

    low: float
    high: float
    logarithmic: bool = False
    of_angles: bool = False
    """Whether it is in degrees, which are marked at parts of a turn."""

    def place(self, values: np.ndarray) -> np.ndarray:
        """Values (n,) as shares of the axis: 0 at the low end, 1 at the high end. NaN stays NaN."""
        if self.logarithmic:
            with np.errstate(divide="ignore", invalid="ignore"):
                return (np.log(values) - np.log(self.low)) / (np.log(self.high) - np.log(self.low))
        return (values - self.low) / (self.high - self.low)

    def ticks(self, most: int = 6) -> tuple[Tick, ...]:
        """Marks at round values: ``most``, or one more, or fewer."""
        values = self._decades(most) if self.logarithmic else self._steps(most)
        labels = [_power(v) for v in values] if self.logarithmic else _decimals(values)
        # Where an axis is hardly longer than its numbers are exact, a mark at its end lies beyond it by rounding.
        places = np.clip(self.place(np.array(values, dtype=float)), 0.0, 1.0)
        return tuple(Tick(float(p), label) for p, label in zip(places, labels, strict=True))

    def _steps(self, most: int) -> list[float]:
        size = 10.0 ** np.floor(np.log10((self.high - self.low) / most))
        steps = [factor * size for factor in (1.0, 2.0, 5.0, 10.0)]
        if self.of_angles and self.high - self.low > _LEAST_TURN:
            steps = [*(step for step in _TURNS if step >= size), 360.0 * np.ceil((self.high - self.low) / 360.0 / most)]
        for step in steps:
            first, last = np.ceil(self.low / step - 1e-9), np.floor(self.high / step + 1e-9)
            if last - first <= most:
                break
        return [float(k * step) for k in np.arange(first, last + 1)]

    def _decades(self, most: int) -> list[float]:
        first, last = int(np.ceil(np.log10(self.low) - 1e-9)), int(np.floor(np.log10(self.high) + 1e-9))
        every = max(1, -(-(last - first + 1) // most))
        decades = [10.0**k for k in range(first, last + 1) if k % every == 0]
        if len(decades) > 2:
            return decades
        between = [m * 10.0**k for k in range(first - 1, last + 1) for m in (1, 2, 5)]
        return [v for v in between if self.low <= v <= self.high]


def linear(*pieces: np.ndarray, room: float = 0.06, zero: bool = False) -> Scale:
    """An axis over all finite values, with ``room`` (a share of its length) to spare at both ends; from zero up if ``zero``."""
    low, high = _extent(pieces)
    if zero:
        return Scale(0.0, high * (1.0 + room) if high > 0 else 1.0)
    spare = room * (high - low) if high > low else max(0.1 * abs(high), 1e-12)
    return Scale(low - spare, high + spare)


def degrees(*pieces: np.ndarray) -> Scale:
    """A linear axis over angles in degrees."""
    found = linear(*pieces)
    return Scale(found.low, found.high, of_angles=True)


def logarithmic(*pieces: np.ndarray, most_decades: float = 9.0) -> Scale:
    """A logarithmic axis over all positive values, at most so many decades down from the largest."""
    low, high = _extent([p[p > 0] for p in pieces])
    if not high > 0:
        return Scale(0.1, 1.0, logarithmic=True)
    low = max(low, high * 10.0**-most_decades)
    return Scale(low / 1.3, high * 1.3, logarithmic=True)


def _extent(pieces: Sequence[np.ndarray]) -> tuple[float, float]:
    together = np.concatenate([np.asarray(p, dtype=float).ravel() for p in pieces])
    finite = together[np.isfinite(together)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


def _decimals(values: Sequence[float]) -> list[str]:
    """As many decimals as tell the marks apart; a common power of ten where that would be too many digits."""
    step = abs(values[1] - values[0]) if len(values) > 1 else abs(values[0]) or 1.0
    largest = max((abs(v) for v in values), default=0.0)
    digits = max(0, -int(np.floor(np.log10(step) + 1e-9)))
    if digits <= 4 and largest < 1e5:
        return [f"{v + 0.0:.{digits}f}".replace("-", "−") for v in values]
    power = int(np.floor(np.log10(largest)))
    digits = max(0, power - int(np.floor(np.log10(step) + 1e-9)))
    unit = f"×10{str(power).translate(_SUPERSCRIPT)}"
    return ["0" if v == 0 else f"{v / 10.0**power:.{digits}f}{unit}".replace("-", "−") for v in values]


def _power(value: float) -> str:
    if 1e-3 < value < 9.9e3:
        return f"{value:g}"
    power = int(np.floor(np.log10(value) + 1e-9))
    factor = f"{value / 10.0**power:.0f}"
    ten = f"10{str(power).translate(_SUPERSCRIPT)}"
    return ten if factor == "1" else f"{factor}·{ten}"
