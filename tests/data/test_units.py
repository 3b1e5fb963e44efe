"""Units that data loggers write."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.data.units import TurnOrRadian, conversion, dimensionality, slip, written_alike
from greybox_torch.errors import UserError

TURNS = 2 * np.pi / 60


@pytest.mark.parametrize("written", ["1/min", "U/min", "r/min", "min^-1", "min-1", "min⁻¹", "[1/min]", "rpm"])
def test_turns_per_minute(written: str) -> None:
    assert conversion(written, "rad/s", "")[0] == pytest.approx(TURNS)
    assert slip(written, "rad/s") == pytest.approx(TURNS)
    assert conversion("deg/s", written, "")[0] == pytest.approx(1 / 6)
    assert conversion("°/s", written, "")[0] == pytest.approx(1 / 6)


def test_a_rate_that_is_not_of_turns() -> None:
    assert conversion("1/min", "1/s", "")[0] == pytest.approx(1 / 60)
    assert conversion("1/min", "1/h", "")[0] == pytest.approx(60)


@pytest.mark.parametrize(
    "written", ["1/min", "U/min", "r/min", "rev/min", "tr/min", "min^-1", "[1/min]", "[U/min]", "rpm"]
)
def test_turns_per_minute_are_rpm(written: str) -> None:
    assert conversion(written, "rpm", "") == pytest.approx((1.0, 0.0))
    assert conversion("rpm", written, "")[0] == pytest.approx(1.0)
    assert conversion(written, "rev/s", "")[0] == pytest.approx(1 / 60)
    assert slip(written, "rpm") is None


def test_the_rate_of_turns_per_minute() -> None:
    assert conversion("1/min / s", "rad/s^2", "")[0] == pytest.approx(TURNS)
    assert conversion("U/min / s", "rpm/s", "")[0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("source", "target", "factor"),
    [("Hz", "rpm", 60), ("rpm", "Hz", 1 / 60), ("kHz", "rev/s", 1e3), ("U/s", "rpm", 60)],
)
def test_a_hertz_is_a_turn_per_second(source: str, target: str, factor: float) -> None:
    assert conversion(source, target, "")[0] == pytest.approx(factor)


@pytest.mark.parametrize(("source", "target"), [("1/s", "rpm"), ("rev/s", "1/s"), ("Hz", "rad/s"), ("deg/s", "Hz")])
def test_nobody_can_tell_turns_from_radians(source: str, target: str) -> None:
    with pytest.raises(TurnOrRadian, match=r"^here: .* the factor as scale$"):
        conversion(source, target, "here")
    assert np.isnan(slip(source, target) or 0.0)


def test_a_per_second_beside_an_angle_is_of_radians() -> None:
    assert conversion("1/s", "rad/s", "")[0] == 1.0


@pytest.mark.parametrize(
    ("source", "target", "factor"),
    [
        ("m/s2", "m/s^2", 1),
        ("m s-2", "m/s^2", 1),
        ("N/m2", "Pa", 1),
        ("Ncm", "N m", 0.01),
        ("lpm", "l/min", 1),
        ("mH2O", "Pa", 9806.65),
    ],
)
def test_usual_spellings(source: str, target: str, factor: float) -> None:
    assert conversion(source, target, "")[0] == pytest.approx(factor)


@pytest.mark.parametrize(
    ("source", "target", "meant"),
    [("kw", "W", "kW"), ("RPM", "rad/s", "rpm"), ("kpa", "Pa", "kPa"), ("KN", "N", "kN"), ("ma", "A", "mA")],
)
def test_what_may_be_meant(source: str, target: str, meant: str) -> None:
    with pytest.raises(UserError, match=f'did you mean "{meant}"'):
        conversion(source, target, "here")


@pytest.mark.parametrize(("written", "size"), [("g", 9.80665), ("mg", 9.80665e-3), ("G", 9.80665), ("[g]", 9.80665)])
def test_gravity_beside_an_acceleration(written: str, size: float) -> None:
    """Whichever of the two the file has. Seen: m/s^2 of a file passed for g."""
    assert conversion(written, "m/s^2", "here")[0] == slip(written, "m/s^2") == pytest.approx(size)
    assert conversion("m/s^2", written, "here")[0] == slip("m/s^2", written) == pytest.approx(1 / size)
    with pytest.raises(UserError, match='"g" cannot be converted to "m"; expected'):
        conversion("g", "m", "here")
    assert [conversion(name, "m/s^2", "")[0] for name in ("g0", "gn", "g_n")] == pytest.approx([9.80665] * 3)


def test_no_unit_of_another_quantity_is_meant() -> None:
    with pytest.raises(UserError, match='"m/s" cannot be converted to "m/s\\^2"; expected'):
        conversion("m/s", "m/s^2", "here")


def test_written_alike() -> None:
    assert all(
        written_alike(*pair)
        for pair in [
            ("°C", "degC"),
            ("degc", "degC"),
            ("N·m", "N m"),
            ("m/s2", "m/s²"),
            ("U/min", "rpm"),
            ("KG", "kg"),
            ("Nm", "N m"),
        ]
    )
    assert not any(written_alike(*pair) for pair in [("mW", "MW"), ("W", "V"), ("mN m", "MN m")])


@pytest.mark.parametrize(
    ("one", "other"), [("N m", "nm"), ("s", "S"), ("A", "a"), ("h", "H"), ("m s", "ms"), ("mN", "m N")]
)
def test_units_of_other_quantities_are_not_alike(one: str, other: str) -> None:
    assert not written_alike(one, other)
    assert not written_alike(other, one)


@pytest.mark.parametrize(("unit", "meant"), [("W/Kelvin", ' (did you mean "W/K"?)'), ("Foo", ""), ("foo/kg", "")])
def test_names_that_begin_with_a_capital(unit: str, meant: str) -> None:
    with pytest.raises(ValueError, match="is not a unit") as refused:
        dimensionality(unit)
    assert str(refused.value) == f'"{unit}" is not a unit{meant}'
