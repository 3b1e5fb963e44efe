"""Inputs stay within range and rate, whatever they are drawn as."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.experiment_design.excitation import KINDS, Excitation, drawn, varied
from greybox_torch.experiment_design.limits import Range

TIME = 0.01 * np.arange(400)
FAST = st.floats(0.3, 12.0)


@given(
    st.sampled_from(KINDS), FAST, FAST, st.floats(-0.9, 0.9), st.floats(0.02, 1.0), st.integers(0, 2**31 - 1),
    st.floats(-50.0, 50.0), st.floats(0.01, 100.0), st.sampled_from([np.inf, 30.0, 1.0]),
)  # fmt: skip
def test_within_range_and_rate(kind, one, other, centre, amplitude, seed, lower, width, rate) -> None:
    within = Range(lower, lower + width, rate)
    values = Excitation(kind, min(one, other), max(one, other), centre, amplitude, seed).sampled(TIME, within)
    slack = 1e-9 * (abs(lower) + width)
    assert values.shape == TIME.shape and np.isfinite(values).all()
    assert values.min() >= within.lower - slack and values.max() <= within.upper + slack
    assert np.abs(np.diff(values) / 0.01).max() <= rate * (1 + 1e-6) + slack / 0.01


@pytest.mark.parametrize("kind", KINDS)
def test_it_moves_as_far_as_it_is_told_around_its_operating_point(kind: str) -> None:
    values = Excitation(kind, 0.5, 5.0, 0.5, 1.0, 3).sampled(TIME, Range(-2.0, 2.0))
    assert 1.0 < values.max() <= 2.0 and -1e-9 <= values.min() < 1.0
    smaller = Excitation(kind, 0.5, 5.0, 0.5, 1.0, 3).smaller(0.1).sampled(TIME, Range(-2.0, 2.0))
    np.testing.assert_allclose(smaller - 1.0, 0.1 * (values - 1.0), atol=1e-12)


def test_a_multisine_has_its_power_in_its_band() -> None:
    values = Excitation("multisine", 2.0, 4.0, 0.0, 1.0, 1).sampled(TIME, Range(-1.0, 1.0))
    power = np.abs(np.fft.rfft(values * np.hanning(len(values)))) ** 2
    band = np.fft.rfftfreq(len(values), 0.01)
    assert power[(band > 1.5) & (band < 4.5)].sum() > 0.98 * power.sum()


def test_draws_repeat_with_their_seed_and_stay_between_the_frequencies() -> None:
    one, other = (drawn(np.random.default_rng(7), 0.25, 12.5) for _ in range(2))
    assert one == other
    rng = np.random.default_rng(1)
    for _ in range(200):
        one = varied(drawn(rng, 0.25, 12.5), rng, 0.25, 12.5)
        assert 0.25 <= one.slow <= one.fast <= 12.5 and 0.02 <= one.amplitude <= 1.0 and abs(one.centre) <= 0.9
