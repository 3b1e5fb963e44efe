from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markupsafe import Markup, escape

from greybox_torch.report import text


@pytest.mark.parametrize(
    ("value", "digits", "shown"),
    [
        (0.0, 3, "0"),
        (1.2345, 3, "1.23"),
        (-1.2345, 3, "−1.23"),
        (0.06012, 3, "0.0601"),
        (123456.0, 3, "123000"),
        (1234567.0, 3, "1.23·10⁶"),
        (-0.0000123, 3, "−1.23·10⁻⁵"),
        (math.nan, 3, "—"),
        (math.inf, 3, "—"),
    ],
)
def test_number(value: float, digits: int, shown: str) -> None:
    assert text.number(value, digits) == shown


@pytest.mark.parametrize(
    ("value", "deviation", "shown"),
    [
        (0.031, 0.0004, "0.03100 ± 0.00040"),
        (20.0774, 0.0263501, "20.077 ± 0.026"),
        (-3.1648, 0.41, "−3.16 ± 0.41"),
        (95.1, 12.3, "95 ± 12"),
        (951.0, 123.0, "950 ± 120"),
        (2.31e-7, 4e-9, "(2.310 ± 0.040)·10⁻⁷"),
        (0.5, 3.0, "0.5 ± 3.0"),
        (490.98, 1.1e6, "491 ± 1.1·10⁶"),  # seen: (0.0 ± 1.1)·10⁶
        (0.358, 840.0, "0.358 ± 840"),  # seen: 0 ± 840
        (0.0, 840.0, "0 ± 840"),
        (0.5, None, "0.5000"),
        (0.5, math.inf, "0.5000"),
        (0.5, 0.0, "0.5000"),
        (math.nan, 0.1, "—"),
        (21.997952936470842, 3e-130, "21.997953 ± 3.0·10⁻¹³⁰"),
        (-2.5e300, 1.0, "−2.5000000·10³⁰⁰ ± 1.0"),
    ],
)
def test_value_with_its_deviation(value: float, deviation: float | None, shown: str) -> None:
    assert text.measured(value, deviation) == shown


@pytest.mark.parametrize(
    ("share", "shown"),
    [
        (0.972, "97 %"),
        (0.9942, "99.4 %"),
        (1.0, "100 %"),
        (0.0062, "0.6 %"),
        (0.0002, "under 0.1 %"),
        (0.0, "0 %"),
        (-0.05, "−5 %"),
        (math.nan, "—"),
    ],
)
def test_percent(share: float, shown: str) -> None:
    assert text.percent(share) == shown


def test_fit() -> None:
    assert text.fit(90.26) == "90.3 %"
    assert text.fit(99.7123, 2) == "99.71 %"
    assert text.fit(-math.inf) == "overflow"
    assert text.fit(-1e7) == "far off"


def test_negative_numbers_of_a_sentence_have_a_minus() -> None:
    """Seen: "-34.2 %" in the headline of a report, and "−34.19 %" below it."""
    told = text.with_minus("goes from -34.2 % to 98.0 %: ±-1, 2025-11-03, x**-2, c-3, 1e-05, high-pass, (-0.5")
    assert told == "goes from −34.2 % to 98.0 %: ±−1, 2025-11-03, x**−2, c-3, 1e-05, high-pass, (−0.5"


def test_units_and_names() -> None:
    assert text.unit("N m/(rad/s)^2") == "N·m/(rad/s)²"
    assert text.unit("kg m^-1") == "kg·m⁻¹"
    assert text.unit("m^3/s/V/Pa^0.5") == "m³/s/V/Pa^0.5", "seen: Pa⁰.5"
    assert text.with_unit("3", "") == "3"
    assert text.axis("motor_speed", "rad/s") == "motor speed [rad/s]"
    assert text.axis("level", "") == "level"
    assert text.axis("T_j", "degC") == "T_j [degC]", "seen: T j"
    assert text.mechanism("coulomb_asymmetry") == "Coulomb asymmetry"
    assert text.first_capital("nonlinear stiffness") == "Nonlinear stiffness"
    assert text.symbol("F_c") == "<i>F</i><sub>c</sub>"
    assert text.symbol("alpha") == "<i>α</i>"
    assert text.symbol("half_gap") == "half_gap", "seen: half width beside ±half_width in the law"
    assert text.symbol("UA_l") == "UA_l"
    assert text.symbol("<b>") == "&lt;b&gt;"


@given(st.from_regex(r"[A-Za-z]{2,8}(_[A-Za-z0-9]{2,8}){0,3}", fullmatch=True), st.sampled_from("abTUq"))
def test_a_name_is_words_or_a_symbol_as_it_is_written(name: str, letter: str) -> None:
    assert "_" not in text.words(name) and text.words(name).split() == name.split("_")
    for indexed in (f"{name}_{letter}", f"{letter}_{name}"):
        assert text.words(indexed) == text.title(indexed) == indexed
    assert text.words(f"{name}_1") == f"{text.words(name)} 1"


@given(st.text(st.characters(codec="ascii", exclude_characters="`")), st.text("ab<&", min_size=1))
def test_a_sentence_for_a_page_is_escaped_and_has_its_code(before: str, code: str) -> None:
    told = text.prose(f"{before}`{code}`")
    assert told == escape(before) + Markup("<code>{}</code>").format(code)


@pytest.mark.parametrize(("value", "shown"), [(0.62, "0.6 s"), (42.3, "42 s"), (119.0, "119 s"), (135.0, "2 min 15 s")])
def test_seconds(value: float, shown: str) -> None:
    assert text.seconds(value) == shown


def test_a_symbol_with_a_capital_stays_as_it_is_written() -> None:
    """Seen: a pressure pA as "PA"."""
    assert text.title("pA") == "pA" and text.title("motor_speed") == "Motor speed" and text.title("stroke") == "Stroke"
