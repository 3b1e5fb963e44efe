"""The fleet's mean, what differs between machines, and which stand out."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.fleets.random_effects import common


def test_by_hand() -> None:
    """Equal deviations: the moments' estimate is the sample variance less that of the measurement."""
    values = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    found = common(values, np.full(5, 0.5))
    assert found.mean == pytest.approx(3.0)
    assert found.between == pytest.approx(np.sqrt(2.5 - 0.25))
    assert found.std == pytest.approx(np.sqrt(2.5 / 5))
    assert found.shrunken == pytest.approx(3.0 + 0.9 * (values - 3.0))
    assert not found.outlying.any()


def test_machines_that_do_not_differ_are_drawn_to_the_mean() -> None:
    found = common(np.array([1.0, 1.1, 0.9, 1.05, 0.95]), np.full(5, 0.5))
    assert found.between == 0.0
    assert found.shrunken == pytest.approx(np.ones(5))


def test_a_poor_estimate_is_drawn_further() -> None:
    values = np.array([1.0, 2.0, 3.0, 4.0, 9.0, 9.0])
    found = common(values, np.array([0.1, 0.1, 0.1, 0.1, 0.1, 5.0]))
    assert found.shrunken[5] < found.shrunken[4] - 1.0


def test_an_outlier_does_not_hide_itself() -> None:
    rng = np.random.default_rng(0)
    values = np.append(1.0 + 0.05 * rng.normal(size=11), 1.8)
    found = common(values, np.full(12, 0.02))
    assert list(np.flatnonzero(found.outlying)) == [11]
    assert found.residuals[11] > 8.0


def test_equal_values_without_deviation() -> None:
    found = common(np.full(6, 2.0), np.zeros(6))
    assert (found.mean, found.between) == (pytest.approx(2.0), 0.0)
    assert np.isfinite(found.shrunken).all() and not found.outlying.any()


def test_false_outliers_are_as_rare_as_said() -> None:
    rng = np.random.default_rng(1)
    false = 0
    for _ in range(200):
        deviations = rng.uniform(0.05, 0.3, 12)
        values = 1.0 + 0.2 * rng.normal(size=12) + deviations * rng.normal(size=12)
        false += common(values, deviations).outlying.any()
    assert false <= 0.09 * 200  # 5 % and two deviations of such a count
