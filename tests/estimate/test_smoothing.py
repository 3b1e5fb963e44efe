"""Measured signals smoothed up to the frequency at which they disappear in their noise."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.estimate.smoothing import band, half_width, smoothed


@pytest.fixture
def rng() -> np.random.Generator:
    """The same draws for every test, whatever ran before in its process."""
    return np.random.default_rng(0)


def test_noise_alone_has_no_band_and_neither_has_standstill(rng: np.random.Generator) -> None:
    assert band(rng.normal(0, 1, 4000)) == 0.0
    assert band(np.full(4000, 3.0)) == 0.0
    assert band(np.arange(20.0)) == 0.0, "too few samples for a spectrum"


@pytest.mark.parametrize("frequency", [0.01, 0.04, 0.12])
def test_the_band_ends_where_the_signal_does(frequency: float, rng: np.random.Generator) -> None:
    t = np.arange(6000)
    y = np.sin(2 * np.pi * frequency * t) + 0.3 * np.sin(0.5 * np.pi * frequency * t) + rng.normal(0, 1e-3, 6000)
    assert frequency <= band(y) < frequency + 0.01, "but for the width of a line in the spectrum"


def test_cubic_polynomials_and_their_slopes_are_kept_exactly() -> None:
    t = np.linspace(-1, 1, 400)
    y, dt = 2 * t**3 - t + 0.5, t[1] - t[0]
    assert smoothed(y, 0.02) == pytest.approx(y, abs=1e-12)
    assert smoothed(y, 0.02, slope=True) / dt == pytest.approx(6 * t**2 - 1, abs=1e-8)


def test_noise_becomes_less_and_a_signal_within_the_band_stays(rng: np.random.Generator) -> None:
    t = np.arange(4000)
    true = np.sin(2 * np.pi * 0.01 * t)
    y = true + rng.normal(0, 0.1, 4000)
    assert np.std(smoothed(y, 0.02) - true) < 0.045


def test_a_signal_with_a_wide_band_is_left_as_it_is(rng: np.random.Generator) -> None:
    y = rng.normal(0, 1, 500)
    assert half_width(0.25, 500) == 0
    assert smoothed(y, 0.25) is y
