from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.data.processing import at_times, decimated, derivative, even_grid
from greybox_torch.data.steps import unevenness
from greybox_torch.data.units import conversion, slip
from greybox_torch.errors import UserError

T = np.arange(2000) * 1e-3


@given(st.floats(0.5, 5.0), st.floats(0, 6))
def test_derivative_of_a_sine_is_its_cosine(frequency: float, phase: float) -> None:
    w = 2 * np.pi * frequency
    found = derivative(np.sin(w * T + phase), 1e-3, 200.0, "q")
    inner = slice(50, -50)
    assert np.max(np.abs(found - w * np.cos(w * T + phase))[inner]) < 0.005 * w


def test_derivative_has_no_delay_and_is_exact_on_a_ramp() -> None:
    np.testing.assert_allclose(derivative(3.0 * T, 1e-3, 20.0, "q"), 3.0, atol=1e-6)


@pytest.mark.parametrize(("cutoff", "values"), [(500.0, T), (20.0, np.where(T > 1, np.nan, T))])
def test_derivative_that_cannot_be(cutoff: float, values: np.ndarray) -> None:
    with pytest.raises(UserError, match=r"q: (a cut-off of 500 Hz; expected less than half|sample 1001 .* is missing)"):
        derivative(values, 1e-3, cutoff, "q")


@given(st.integers(2, 30))
def test_decimation_keeps_slow_and_stops_fast(factor: int) -> None:
    np.testing.assert_allclose(decimated(np.full(2000, 3.0), factor), 3.0)
    slow, fast = np.sin(2 * np.pi * 0.5 * T), np.sin(2 * np.pi * (1000 / factor) * 0.97 * T)
    inner = slice(10, -10)
    assert np.max(np.abs(decimated(slow, factor) - slow[::factor])[inner]) < 0.02
    assert np.max(np.abs(decimated(fast, factor))[inner]) < 0.02


def test_decimation_with_gaps() -> None:
    values = np.full(200, 3.0)
    values[40:80] = np.nan
    found = decimated(values, 5)
    assert np.isnan(found[8:16]).all()
    np.testing.assert_allclose(np.delete(found, np.s_[8:16]), 3.0)


def test_at_times() -> None:
    stamps, values = np.array([0.0, 1.0, 3.0, 4.0]), np.array([0.0, 10.0, 30.0, np.nan])
    np.testing.assert_array_equal(
        at_times(np.array([-1, 0, 0.5, 2, 3, 3.5, 4, 5]), stamps, values),
        [np.nan, 0, 5, 20, 30, np.nan, np.nan, np.nan],
    )
    np.testing.assert_array_equal(even_grid(stamps, 2.0, ""), [0, 2, 4])
    assert unevenness(stamps) == 1.0
    for step in (5.0, 1e-9):
        with pytest.raises(UserError, match=r"resample = .* makes"):
            even_grid(stamps, step, "x")


@pytest.mark.parametrize(
    ("source", "target", "factor", "offset"),
    [
        ("deg/s", "rad/s", np.pi / 180, 0),
        ("rpm", "rad/s", np.pi / 30, 0),
        ("rev/min", "rad/s", np.pi / 30, 0),
        ("N cm", "N m", 0.01, 0),
        ("Nm", "N m", 1, 0),
        ("mA", "A", 1e-3, 0),
        ("°C", "K", 1, 273.15),
        ("°", "rad", np.pi / 180, 0),
        ("m/s²", "mm/s^2", 1000, 0),
        ("kg·m²", "g cm^2", 1e7, 0),
        ("l/min", "m^3/s", 1 / 60000, 0),
    ],
)
def test_units(source: str, target: str, factor: float, offset: float) -> None:
    assert conversion(source, target, "") == pytest.approx((factor, offset))


@pytest.mark.parametrize(
    "source", ["V", "wobble", "", "9**9**9", "m^999", "__import__", "Hz", "m" * 50, "rad/s)", "1e999 rad/s"]
)
def test_units_that_cannot_be(source: str) -> None:
    with pytest.raises(UserError, match="here: "):
        conversion(source, "rad/s", "here")


def test_slips() -> None:
    assert slip("deg/s", "rad/s") == pytest.approx(np.pi / 180)
    assert slip("rad / s", "rad/s") is None
    assert slip("wobble", "rad/s") is None
