"""Differences that tell noise from motion, whatever rows the samples stand in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from greybox_torch.diagnosis.hypothesis.differences import _divided, differences, of_white_noise
from greybox_torch.diagnosis.settings import DiagnosisSettings

ROWS, STEP = 6000, 2e-3


def motion(time: np.ndarray) -> np.ndarray:
    """A carriage that moves half a metre there and back, m."""
    return 0.25 * np.sin(2 * np.pi * 0.4 * time) + 0.05 * np.sin(2 * np.pi * 1.3 * time + 1.0)


def shown(y: np.ndarray, time: np.ndarray, order: int = 3) -> float:
    """The standard deviation of the noise by its differences."""
    return float(np.sqrt(np.mean(differences(y, time, order) ** 2) / of_white_noise(order)))


def in_rows(ratio: float, noise: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Every ``ratio``-th row has a sample, as nearly as rows allow."""
    time = STEP * np.arange(ROWS)
    known = np.unique(np.rint(np.arange(0.0, ROWS - 1, ratio)).astype(int))
    y = np.full(ROWS, np.nan)
    y[known] = motion(time[known]) + noise * np.random.default_rng(seed).standard_normal(len(known))
    return y, time


@settings(max_examples=40, deadline=None)
@given(
    st.floats(1.5, 6.0),
    st.floats(1e-4, 1e-2),
    st.sampled_from([3, 4, 5]),
    st.floats(0.0, 2e9),
    st.integers(0, 10),
)
def test_the_noise_of_a_slower_sensor_is_shown_whatever_rows_its_samples_stand_in(ratio, noise, order, start, seed):
    """Seen: samples 2 and 3 rows apart in turn, whose motion was told as 60 times the noise."""
    y, time = in_rows(ratio, noise, seed)
    assert shown(y, time + start, order) == pytest.approx(noise, rel=0.15)


def test_the_noise_of_samples_2_and_3_rows_apart_in_turn_is_shown_where_motion_is_far_larger():
    """Seen: the motion between them, told as 60 times the noise."""
    order, noise = DiagnosisSettings().noise_differences, 5e-6
    y, time = in_rows(2.5, noise, 0)
    known = y[~np.isnan(y)]
    assert set(np.diff(np.flatnonzero(~np.isnan(y)))) == {2, 3}
    taken_as_even = np.sqrt(np.mean(np.diff(known, order) ** 2) / of_white_noise(order))
    assert taken_as_even > 10.0 * noise
    assert shown(y, time, order) == pytest.approx(noise, rel=0.15)


def test_few_samples_in_a_row_do_not_speak_for_all_others():
    y, time = in_rows(4.0, 1e-4, 0)
    y[100:105] = motion(time[100:105]) + 1e-2 * np.random.default_rng(1).standard_normal(5)
    assert shown(y, time) < 1e-3


def test_many_samples_in_a_row_do():
    """Across what is missing there is more motion."""
    y, time = in_rows(1.0, 1e-6, 0)
    y[np.random.default_rng(0).random(ROWS) < 0.4] = np.nan
    assert shown(y, time) == pytest.approx(1e-6, rel=0.15)


def test_even_samples_whose_stamps_are_rounded_are_taken_as_even():
    y, time = in_rows(1.0, 1e-5, 0)
    assert shown(y, np.round(1.25 * time, 3)) == pytest.approx(1e-5, rel=0.15)


def test_rows_that_the_logger_left_out_are_no_noise():
    y, time = in_rows(1.0, 1e-5, 0)
    kept = np.random.default_rng(0).random(ROWS) > 0.1
    assert shown(y[kept], time[kept]) == pytest.approx(1e-5, rel=0.15)


@pytest.mark.parametrize("there", [0, 2, 3])
def test_too_few_samples_show_none(there):
    y = np.full(20, np.nan)
    y[:there] = 1.0
    assert differences(y, np.arange(20.0), 3).size == 0


@pytest.mark.parametrize("length", [0, 1, 3, 4])
@pytest.mark.parametrize("value", [np.nan, 1.0])
def test_an_output_that_is_shorter_than_their_order_shows_none(length, value):
    """Seen: an IndexError of the window of samples in a row."""
    assert differences(np.full(length, value), np.arange(float(length)), 4).size == 0


@given(st.lists(st.floats(0.2, 5.0), min_size=8, max_size=40), st.sampled_from([3, 4, 5]), st.integers(0, 2**32 - 1))
def test_divided_differences_are_those_of_polynomials(steps, order, seed):
    """They take a polynomial of less than their order out of a motion, at any stamps, and keep the size of white noise."""
    time = np.cumsum(steps)
    smooth = np.polynomial.Polynomial(np.random.default_rng(seed).standard_normal(order))(
        (time - time[0]) / np.ptp(time)
    )
    assert np.abs(_divided(smooth, time, order)).max() < 1e-6 * max(np.abs(smooth).max(), 1.0)
    weights = np.array([_divided(row, time, order) for row in np.eye(len(time))])
    assert (weights**2).sum(axis=0) == pytest.approx(of_white_noise(order))
