from __future__ import annotations

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


def test_shown() -> None:
    speed = dimension_of("deg/s")
    assert speed is not None
    assert str(speed) == "rad/s"
    assert str(speed.times(SECOND, -1)) == "rad/s^2"
    assert str(dimension_of("kg/m^3")) == "kg/m^3"
    assert str(dimension_of("m^3/(kg s^2)")) == "m^3/(kg s^2)"
