"""When something changed, and that chance is rarely taken for a change."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import pytest
from scipy import stats

from greybox_torch.fleets.change_points import chance_of_presence, change_points

RNG = np.random.default_rng


def test_a_shift_is_dated() -> None:
    values = np.r_[np.full(5, 1.0), np.full(7, 2.0)] + 0.1 * RNG(0).normal(size=12)
    (change,) = change_points(values)
    assert change.index == 5
    assert (change.before, change.after) == (pytest.approx(1.0, abs=0.1), pytest.approx(2.0, abs=0.1))
    assert change.p < 1e-4


def test_two_shifts() -> None:
    values = np.r_[np.zeros(8), np.ones(8), np.full(8, -1.0)] + 0.1 * RNG(4).normal(size=24)
    assert [change.index for change in change_points(values)] == [8, 16]


def test_exact_steps_and_constants() -> None:
    assert [c.index for c in change_points(np.r_[np.zeros(4), np.ones(4)])] == [4]
    assert change_points(np.ones(12)) == ()


def test_a_single_outlier_is_no_change() -> None:
    values = 0.1 * RNG(2).normal(size=12)
    values[6] = 5.0
    assert change_points(values) == ()


def test_too_few_recordings() -> None:
    assert change_points(np.r_[np.zeros(2), np.ones(3)]) == ()


def test_what_appears() -> None:
    (change,) = change_points(np.r_[np.zeros(6), np.ones(6)], binary=True)
    assert (change.index, change.before, change.after) == (6, 0.0, 1.0)
    assert change.p == pytest.approx(2 / 924)  # of all orders of six and six two are like this
    assert change_points(np.array([0.0, 1, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1]), binary=True) == ()


def test_the_level_is_what_decides() -> None:
    assert change_points(np.r_[np.zeros(6), np.ones(6)], binary=True, level=0.002) == ()


@pytest.mark.parametrize(
    "values", [(0, 0, 0, 1, 1, 1), (0, 1, 0, 0, 1, 1, 1), (0, 0, 1, 1, 0, 1, 1, 1), (1, 0, 0, 0, 0, 0, 1, 0)]
)
def test_the_chance_of_an_order_is_exact(values: tuple[int, ...]) -> None:
    """Against counting all orders."""
    n, ones = len(values), sum(values)

    def least(order: Sequence[int]) -> float:
        tables = (
            [[sum(order[:k]), k - sum(order[:k])], [sum(order[k:]), n - k - sum(order[k:])]] for k in range(2, n - 1)
        )
        return min(float(stats.fisher_exact(table).pvalue) for table in tables)

    orders = [[int(i in chosen) for i in range(n)] for chosen in itertools.combinations(range(n), ones)]
    as_unlikely = sum(least(order) <= least(values) * (1.0 + 1e-9) for order in orders)
    assert chance_of_presence(np.array(values, float)) == pytest.approx(as_unlikely / len(orders))


def test_ten_recordings_are_enough_for_what_appears() -> None:
    (change,) = change_points(np.r_[np.zeros(5), np.ones(5)], binary=True, level=0.025)
    assert change.index == 5


def test_changes_are_dated_within_a_recording_and_false_ones_are_rare() -> None:
    rng = RNG(3)
    false = sum(bool(change_points(rng.normal(size=12))) for _ in range(150))
    dated = 0
    for _ in range(60):
        values = rng.normal(size=12)
        values[6:] += 6.0
        found = change_points(values, level=0.02)
        dated += len(found) == 1 and abs(found[0].index - 6) <= 1
    assert false <= 0.086 * 150  # 5 % and two deviations of such a count
    assert dated >= 0.9 * 60
