from __future__ import annotations

from fractions import Fraction

import pytest

from greybox_torch.checking.dimensions import NONE, SECOND, dimension_of


@pytest.mark.parametrize(
    ("unit", "same"),
    [("N m", "kg m^2/s^2"), ("rad/s", "1/s"), ("rpm", "rad/s"), ("N m s/rad", "J s"), ("Ohm", "V/A"), ("V s/rad", "N m/A")],
)  # fmt: skip
def test_same_dimension(unit: str, same: str) -> None:
    assert dimension_of(unit) == dimension_of(same)


def test_no_unit_and_no_dimension() -> None:
    assert dimension_of("") is None
    assert dimension_of("1") == dimension_of("rad") == dimension_of("%") == NONE


def test_what_is_no_unit() -> None:
    with pytest.raises(ValueError, match='"furlonk" is not a unit'):
        dimension_of("furlonk")


@pytest.mark.parametrize("unit", ["1e6 kg m^2", "1e-3 m", "10^6 N", "1000 kg", "0.1 N", "1e3"])
def test_a_number_in_front_is_no_part_of_a_unit(unit: str) -> None:
    """Seen: "is not a unit" without a hint, and 1e-3 m in cubes of coulombs."""
    with pytest.raises(ValueError, match="is not a unit: it begins with a number"):
        dimension_of(unit)


def test_one_in_front_is_usual() -> None:
    assert dimension_of("1/s") == dimension_of("1 / s") == dimension_of("1.0/s") == dimension_of("Hz")
    assert dimension_of("1 kg") == dimension_of("kg")


def test_shown() -> None:
    speed = dimension_of("deg/s")
    assert speed is not None
    assert str(speed) == "rad/s"
    assert str(speed.times(SECOND, -1)) == "rad/s^2"
    assert str(dimension_of("kg/m^3")) == "kg/m^3"
    assert str(dimension_of("m^3/(kg s^2)")) == "m^3/(kg s^2)"
    assert str(speed.to_the(Fraction(1, 2))) == "1/s^(1/2)", "s^1/2 reads as half of it"
