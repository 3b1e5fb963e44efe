"""Parameters are drawn with the deviations and correlations that they have, whatever their units."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.experiment_design.draws import drawn_with

EXPONENTS = st.lists(st.integers(-12, 12), min_size=3, max_size=3)


@given(exponents=EXPONENTS)
def test_draws_have_the_deviations_and_correlations_of_a_covariance_of_any_units(exponents: list[int]) -> None:
    """Seen: a valve's gain of 3e-7 beside a bulk modulus of 1e9 Pa, drawn as 1e-3, and evidence of 1e11 nats."""
    size = 10.0 ** np.array(exponents)
    correlation = np.array([[1.0, 0.9, 0.0], [0.9, 1.0, -0.3], [0.0, -0.3, 1.0]])
    rng = np.random.default_rng(7)
    draws = np.array([drawn_with(correlation * np.outer(size, size), rng) for _ in range(2000)]) / size
    assert np.std(draws, axis=0) == pytest.approx(1.0, rel=0.08)
    assert np.corrcoef(draws.T) == pytest.approx(correlation, abs=0.08)


def test_what_is_known_exactly_stays() -> None:
    rng = np.random.default_rng(7)
    draws = np.array([drawn_with(np.diag([0.0, 4.0]), rng) for _ in range(50)])
    assert (draws[:, 0] == 0.0).all() and np.std(draws[:, 1]) == pytest.approx(2.0, rel=0.4)
