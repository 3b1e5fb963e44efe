from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from greybox_torch.estimate.residuals import feedback_correlation, input_correlation, is_slower, whiteness

Noise = Callable[[np.random.Generator, int], np.ndarray]


def white(rng: np.random.Generator, n: int) -> np.ndarray:
    return rng.standard_normal(n)


def coloured(rng: np.random.Generator, n: int) -> np.ndarray:
    return lfilter([1.0], [1.0, -0.9], rng.standard_normal(n + 200))[200:]


def periodic(rng: np.random.Generator, n: int) -> np.ndarray:
    phases = rng.uniform(0, 2 * np.pi, 39)
    return sum(np.cos(2 * np.pi * k * np.arange(n) / 200 + phase) for k, phase in enumerate(phases, start=1))


def with_gaps(rng: np.random.Generator, values: np.ndarray) -> np.ndarray:
    return np.where(rng.random(len(values)) < 0.3, np.nan, values)


def test_white_noise_stays_inside_its_bound() -> None:
    rng = np.random.default_rng(0)
    found = [whiteness(white(rng, 1500)) for _ in range(200)]
    assert {f.tested for f in found} == {25}
    assert 0.005 < sum(f.outside for f in found) / (200 * 25) < 0.015
    assert found[0].bound == pytest.approx(2.58 / np.sqrt(1500))


@pytest.mark.parametrize("errors", [white, coloured])
@pytest.mark.parametrize("signal", [white, coloured, periodic])
def test_errors_that_have_nothing_to_do_with_the_input(errors: Noise, signal: Noise) -> None:
    """Whatever the colours, about one value in a hundred lies outside: the bound allows for them."""
    rng = np.random.default_rng(1)
    found = [input_correlation(errors(rng, 2000), 5.0 + signal(rng, 2000)) for _ in range(200)]
    assert {f.tested for f in found} == {26}
    assert 0.002 < sum(f.outside for f in found) / (200 * 26) < 0.02


def test_gaps_do_not_raise_false_alarms() -> None:
    rng = np.random.default_rng(2)
    pairs = [(with_gaps(rng, white(rng, 1500)), coloured(rng, 1500)) for _ in range(100)]
    assert sum(whiteness(e).outside for e, _ in pairs) / (100 * 25) < 0.015
    assert sum(input_correlation(e, u).outside for e, u in pairs) / (100 * 26) < 0.02


def test_missing_dynamics_are_seen() -> None:
    """A tenth of the noise's size, from three samples ago."""
    rng = np.random.default_rng(3)
    u = white(rng, 5000)
    errors = white(rng, 5000) + 0.1 * np.roll(u, 3)
    found = input_correlation(errors, u)
    assert found.largest > found.bound
    assert found.lags[np.argmax(np.abs(found.values))] == 3
    assert found.values[np.argmax(np.abs(found.values))] == pytest.approx(0.1, abs=0.03)
    assert whiteness(errors).outside <= 2


def test_feedback_shows_at_negative_lags_and_is_not_held_against_the_model() -> None:
    rng = np.random.default_rng(4)
    errors = white(rng, 5000)
    found = input_correlation(errors, np.roll(errors, 4) + white(rng, 5000))
    assert found.lags[np.argmax(np.abs(found.values))] == -4
    assert found.outside <= 2


def test_values_by_hand() -> None:
    e = np.array([1.0, -2.0, 3.0, 1.0])
    found = whiteness(e, lags=2)
    assert found.lags.tolist() == [1, 2]
    np.testing.assert_allclose(found.values, np.array([-2 - 6 + 3, 3 - 2]) / 15)
    u = np.array([1.0, 0.0, 0.0, -1.0])
    crossed = input_correlation(e, u, lags=1)
    # e(t) u(t − k) at k = −1, 0, 1
    np.testing.assert_allclose(crossed.values, np.array([-3.0, 0.0, -2.0]) / np.sqrt(15 * 2), atol=1e-15)
    assert crossed.largest == pytest.approx(2 / np.sqrt(30))


def test_nothing_to_correlate() -> None:
    assert whiteness(np.zeros(50)).largest == 0.0
    assert input_correlation(np.random.default_rng(0).standard_normal(50), np.full(50, 3.0)).largest == 0.0
    assert input_correlation(np.zeros(50), np.arange(50.0)).largest == 0.0
    # seen: 0.43 with a rope of 0.9 m, as the mean of 2000 times 0.9 is not 0.9
    rope = input_correlation(np.random.default_rng(0).standard_normal(2000), np.full(2000, 0.9))
    assert (rope.defined, rope.largest) == (False, 0.0)
    assert input_correlation(np.random.default_rng(0).standard_normal(50), np.arange(50.0)).defined
    assert whiteness(np.arange(12.0)).tested == 11


@pytest.mark.parametrize("signal", [white, coloured, periodic])
def test_a_wrong_model_in_open_loop_is_no_feedback(signal: Noise) -> None:
    """Errors that the input explains altogether, in a way that is not linear."""
    rng, outside = np.random.default_rng(5), 0
    for _ in range(50):
        u = signal(rng, 2000)
        found = feedback_correlation(np.abs(lfilter([0.0, 1.0], [1.0, -0.9], u)) + 0.1 * white(rng, 2000), u)
        outside += found.outside
    assert outside / (50 * found.tested) < 0.02


def test_feedback_is_seen_behind_a_wrong_model_and_under_a_coloured_input() -> None:
    """A hundredth of the input is noise that comes back after two samples; most of the error is of the model's making."""
    rng = np.random.default_rng(6)
    noise, wanted = 0.1 * white(rng, 4000), 10.0 * lfilter([1.0], [1.0, -1.9, 0.91], white(rng, 4000))
    u = wanted + lfilter([0.0, 0.0, 0.2 * wanted.std()], [1.0], noise)
    found = feedback_correlation(lfilter([0.0, 0.5], [1.0, -0.9], wanted) / wanted.std() + noise, u)
    largest = int(np.argmax(np.abs(found.values)))
    assert found.lags[largest] == 2
    assert found.values[largest] > 3.0 * found.bound


def every(step: int, errors: np.ndarray) -> np.ndarray:
    """Errors of a sensor that is slower than the recording."""
    return np.where(np.arange(len(errors)) % step == 0, errors, np.nan)


@pytest.mark.parametrize("signal", [white, coloured])
def test_a_wrong_model_is_no_feedback_of_a_slower_sensor_either(signal: Noise) -> None:
    """What the sensor's samples leave out of the input is in the errors, and goes on in the input."""
    rng, outside = np.random.default_rng(5), 0
    for _ in range(30):
        u = lfilter([1.0], [1.0, -0.9], signal(rng, 8000))
        found = feedback_correlation(every(4, lfilter([0.0, 1.0], [1.0, -0.9], u) + 0.1 * white(rng, 8000)), u)
        outside += found.outside
    assert outside / (30 * found.tested) < 0.02


@pytest.mark.parametrize("step", [2, 5])
def test_feedback_is_seen_of_a_slower_sensor_too(step: int) -> None:
    """Seen: not a word of it, as none of the errors has enough others in a row before it."""
    rng = np.random.default_rng(8)
    noise = 0.1 * white(rng, 8000)
    u = white(rng, 8000) + lfilter([*np.zeros(step), 5.0], [1.0], noise)
    found = feedback_correlation(every(step, noise), u)
    largest = int(np.argmax(np.abs(found.values)))
    assert found.lags[largest] == 1 and found.values[largest] > 3.0 * found.bound


def test_an_input_without_anything_new() -> None:
    rng = np.random.default_rng(7)
    assert feedback_correlation(white(rng, 2000), periodic(rng, 2000)).largest == 0.0
    assert feedback_correlation(white(rng, 2000), np.full(2000, 3.0)).largest == 0.0
    assert feedback_correlation(np.full(40, np.nan), white(rng, 40)).largest == 0.0


@settings(max_examples=30, deadline=None)
@given(st.floats(1.6, 9.0), st.integers(0, 100))
def test_lags_of_a_slower_sensor_are_in_its_own_samples(ratio: float, seed: int) -> None:
    """Seen: 0, 0.5, 0.5, 0, 1, 0 … over the lag, of a sensor with a sample in 2 and 3 rows in turn."""
    rng = np.random.default_rng(seed)
    rows = np.unique(np.rint(np.arange(0, 3999, ratio)).astype(int))
    known, u = coloured(rng, len(rows)), coloured(rng, int(rows[-1]) + 1)
    errors = np.full(len(u), np.nan)
    errors[rows] = known
    assert is_slower(errors) and not is_slower(u)
    for found, own in (
        (whiteness(errors), whiteness(known)),
        (input_correlation(errors, u), input_correlation(known, u[rows])),
    ):
        np.testing.assert_array_equal(found.values, own.values)
        assert (found.bound, found.tested) == (own.bound, own.tested)


@given(st.floats(0.55, 0.95), st.integers(0, 100))
def test_samples_lost_at_random_are_of_no_slower_sensor(lost: float, seed: int) -> None:
    """Seen: "sampled more slowly than the rest" of an output with more than half of its samples lost."""
    rng = np.random.default_rng(seed)
    errors = np.where(rng.random(4000) < lost, np.nan, 1.0)
    assert not is_slower(errors) and whiteness(errors).tested == 25


@given(st.floats(2.0, 9.0), st.floats(0.0, 0.08), st.integers(0, 100))
def test_a_slower_sensor_may_lack_some_samples(ratio: float, lost: float, seed: int) -> None:
    rows = np.unique(np.rint(np.arange(0, 3999, ratio)).astype(int))
    errors = np.full(4000, np.nan)
    errors[rows] = np.where(np.random.default_rng(seed).random(len(rows)) < lost, np.nan, 1.0)
    assert is_slower(errors)
