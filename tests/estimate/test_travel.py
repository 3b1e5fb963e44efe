"""The way of a body whose position is integrated from its speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.travel import comes_back, either_way, integrated


class Kept:
    """Two experiments of 50 and 30 samples at 0.1 s."""

    lengths, dt = np.array([50, 30]), np.full(80, 0.1)

    def span(self, experiment: int) -> slice:
        return slice(0, 50) if experiment == 0 else slice(50, 80)


records: Any = Kept()


def test_positions_begin_at_zero_in_every_experiment() -> None:
    found = integrated(np.full(80, 2.0), records)
    np.testing.assert_allclose(found[:50], 0.2 * np.arange(50))
    np.testing.assert_allclose(found[50:], 0.2 * np.arange(30))


@pytest.mark.parametrize(
    ("way", "back"),
    [
        (lambda n: np.exp(-0.05 * n), False),
        (lambda n: n - 0.05 * np.sin(n), False),
        (lambda n: np.sin(0.3 * n), True),
        (lambda n: -np.abs(n - 35.0), True),
        (lambda n: np.zeros_like(n), False),
    ],
    ids=["runs out", "trembles on its way", "to and fro", "turns once, in the first alone", "stands still"],
)
def test_what_passes_each_place_once_does_not_come_back(way, back) -> None:
    """Seen: tyres on a drum that runs out, told as unknown over 4.5 km of way (0.97), 56 knots, which was when and not where."""
    position = np.concatenate([way(np.arange(50.0)), np.arange(30.0)])
    assert comes_back(position, records) is back


@pytest.mark.parametrize(
    ("values", "either"),
    [
        (np.sin(np.arange(200.0)), True),
        (np.arange(200.0), False),
        (-np.arange(200.0), False),
        (np.r_[np.arange(200.0), -50.0], False),
        (np.r_[np.arange(200.0), np.full(10, -50.0), np.nan], True),
        (np.arange(200.0) - 2.0, False),
    ],
    ids=["to and fro", "one way", "the other", "a single sample", "a twentieth of the time", "by little"],
)
def test_a_signal_goes_either_way_where_it_does_so_for_a_while_and_by_more_than_little(values, either) -> None:
    """Seen: the static curve of a drive that never brakes, told at its motor, over the command along the motion times the direction."""
    assert either_way(values) is either
