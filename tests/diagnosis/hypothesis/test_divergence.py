"""How far fitted outputs lie apart, and of how many independent samples errors are."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis import divergence as measured
from greybox_torch.diagnosis.hypothesis.divergence import correlation_length, divergence


@pytest.fixture
def hypothesis(stub, monkeypatch):
    """A hypothesis of which only the errors (n_y, N) that it leaves are known."""
    monkeypatch.setattr(measured, "window_errors", lambda fit, simulator: fit)
    return lambda errors: stub(fits=(np.atleast_2d(errors),), simulator=None)


def noise(seed: int, count: int = 4000) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=count)


def test_half_the_squared_difference_in_units_of_the_error(hypothesis) -> None:
    one = noise(0)
    other = one + 0.05
    expected = 0.5 * 0.05**2 * len(one) / np.mean(one**2)
    assert divergence(hypothesis(one), hypothesis(other)) == pytest.approx(expected, rel=1e-6)


def test_outputs_add_and_missing_samples_say_nothing(hypothesis) -> None:
    both = np.stack([noise(0), 10 * noise(1)])
    other = both + np.array([[0.05], [0.5]])
    whole = divergence(hypothesis(both), hypothesis(other))
    assert whole == pytest.approx(2 * 5.0, rel=0.1)
    holes = both.copy()
    holes[1] = np.nan
    assert divergence(hypothesis(holes), hypothesis(other)) == pytest.approx(0.5 * whole, rel=0.1)


def test_the_same_outputs_do_not_differ(hypothesis) -> None:
    assert divergence(hypothesis(noise(0)), hypothesis(noise(0))) == 0.0


def test_correlated_errors_count_once(hypothesis) -> None:
    """An autoregression of first order with pole a: 1 + 2 Σ aᵏ = (1 + a) / (1 − a) samples for one."""
    pole, errors = 0.8, np.zeros(40_000)
    for k, new in enumerate(noise(3, len(errors) - 1), start=1):
        errors[k] = pole * errors[k - 1] + new
    assert correlation_length(errors) == pytest.approx((1 + pole) / (1 - pole), rel=0.12)
    assert correlation_length(noise(4)) == 1.0 and correlation_length(np.ones(10)) == 1.0
    alike = noise(5, len(errors)) * errors.std()
    far = 0.1 * errors.std()
    correlated, white = (divergence(hypothesis(e), hypothesis(e + far)) for e in (errors, alike))
    assert correlated == pytest.approx(white / 9, rel=0.12)
