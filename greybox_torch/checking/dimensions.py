"""Dimensions of units, as powers of the base quantities; plane angle has none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from greybox_torch.data.units import dimensionality

_BASE = {
    "[mass]": "kg",
    "[length]": "m",
    "[time]": "s",
    "[current]": "A",
    "[temperature]": "K",
    "[substance]": "mol",
    "[luminosity]": "cd",
}
_NAMED = (
    "N m",
    "N",
    "W",
    "Pa",
    "V",
    "rad/s",
    "rad/s^2",
    "m/s",
    "m/s^2",
    "N m s/rad",
    "N s/m",
    "N/m",
    "kg m^2",
    "V/s",
    "A/s",
    "K/s",
    "W/K",
)
"""How dimensions are shown where one of these has them."""

_PLAIN = ("1", "-", "–")
"""How the unit of plain numbers is written."""

_TEMPERATURES = ("K", "degC", "°C", "C")
"""Units of temperatures that differ by their zero alone."""


@dataclass(frozen=True)
class Dimension:
    """Powers of base quantities, none of them zero."""

    powers: tuple[tuple[str, Fraction], ...] = ()

    @staticmethod
    def of(powers: Mapping[str, Fraction]) -> Dimension:
        return Dimension(tuple(sorted((name, power) for name, power in powers.items() if power)))

    def times(self, other: Dimension, power: int | Fraction = 1) -> Dimension:
        """This dimension multiplied by a power of another."""
        powers = dict(self.powers)
        for name, own in other.powers:
            powers[name] = powers.get(name, Fraction(0)) + own * power
        return Dimension.of(powers)

    def to_the(self, power: Fraction) -> Dimension:
        return NONE.times(self, power)

    @property
    def has_name(self) -> bool:
        """Whether it is told by a usual unit, or is one base unit in some power, or a plain number."""
        return len(self.powers) < 2 or self._named is not None

    @property
    def _named(self) -> str | None:
        return next((unit for unit in _NAMED if dimension_of(unit) == self), None)

    def __str__(self) -> str:
        """The dimension as a unit of its own, of something that turns."""
        return self.told(turning=True)

    def told(self, *, turning: bool) -> str:
        """The dimension as a unit: an angle has none, so that what is not ``turning`` is in 1/s where an angular speed is in rad/s."""
        if self._named is not None and (turning or not self._named.startswith("rad")):
            return self._named
        above = " ".join(_term(name, power) for name, power in self.powers if power > 0)
        below = " ".join(_term(name, -power) for name, power in self.powers if power < 0)
        return (above or "1") + (f"/({below})" if " " in below else f"/{below}" if below else "")


NONE = Dimension()
SECOND = Dimension((("[time]", Fraction(1)),))
WATT = Dimension.of({"[mass]": Fraction(1), "[length]": Fraction(2), "[time]": Fraction(-3)})


def _term(name: str, power: Fraction) -> str:
    unit = _BASE.get(name, name)
    return unit if power == 1 else f"{unit}^{power}" if power.denominator == 1 else f"{unit}^({power})"


def per_second(unit: str) -> str:
    """How the unit of the rate of what is in ``unit`` is told; nothing where that has none."""
    if unit.strip() in _PLAIN:
        return "1/s"
    if unit.strip() in _TEMPERATURES:  # a difference of degrees is as large in K
        return "K/s"
    return f"{unit} per second" if unit.strip() else ""


def known_dimension(unit: str) -> Dimension | None:
    """The dimension of a unit as it is written; None where nothing is written, and for what is no unit, which is told elsewhere."""
    try:
        return dimension_of(unit)
    except ValueError:
        return None


def dimension_of(unit: str) -> Dimension | None:
    """The dimension of a unit as it is written; None where nothing is written. Raises ValueError for what is no unit."""
    if not unit.strip():
        return None
    if unit.strip() in _PLAIN:
        return NONE
    return Dimension.of({name: Fraction(power).limit_denominator(12) for name, power in dimensionality(unit).items()})
