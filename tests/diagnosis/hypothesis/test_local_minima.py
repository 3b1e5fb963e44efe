"""Fits over windows of several lengths that show one another's local minima."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.hypothesis.fit import window_lengths
from greybox_torch.diagnosis.hypothesis.local_minima import no_worse_than_longer
from greybox_torch.diagnosis.settings import SearchBudget


@pytest.fixture
def plain(motor_data, motor, begun):
    """A motor without any effect, fitted."""
    return begun(motor_data(torque=lambda q, v: 0.0), motor).plain


def test_a_fit_over_short_windows_that_is_worse_than_over_long_ones_is_begun_where_those_led(plain) -> None:
    own, *longer = plain.fits
    far = own.problem.with_values(1.3 * own.problem.values)
    stuck = replace(own, problem=far, mean_square=10.0 * longer[0].mean_square)
    limits = SearchBudget().window_iterations
    first, *rest = no_worse_than_longer([stuck, *longer], window_lengths(own.problem), plain.simulator, limits)
    assert rest == longer
    assert first.mean_square == pytest.approx(own.mean_square, rel=0.01)
    assert first.problem.values == pytest.approx(own.problem.values, rel=0.05)


def test_fits_in_their_order_stay_as_they_are(plain) -> None:
    limits = SearchBudget().window_iterations
    found = no_worse_than_longer(plain.fits, window_lengths(plain.problem), plain.simulator, limits)
    assert all(one is other for one, other in zip(found, plain.fits, strict=True))
