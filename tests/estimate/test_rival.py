"""Of several fits of the same, those that cannot come level are given up."""

from __future__ import annotations

import pytest

from greybox_torch.estimate.rival import FAIR_START, Rival


@pytest.mark.parametrize(
    ("mean_square", "change", "done", "left", "lost"),
    [
        (1e9, 0.0, FAIR_START - 1, 7, False),  # the first iterations tell little
        (1.01, 0.5, 10, 0, True),
        (0.99, 0.0, 5, 5, False),  # ahead
        (0.9**-10 * 1.01, 0.1, 5, 5, True),
        (0.9**-10 * 0.99, 0.1, 5, 5, False),  # may come level yet
    ],
)
def test_a_fit_may_be_the_farther_behind_the_faster_it_gains(mean_square, change, done, left, lost) -> None:
    assert Rival(1.0, pace=2.0).lost(mean_square, change, done, left) is lost
