"""Of several fits of the same, those that are far behind are given up."""

from __future__ import annotations

import pytest

from greybox_torch.estimate.rival import FAIR_START, Rival


@pytest.mark.parametrize(
    ("mean_square", "done", "left", "lost"),
    [
        (1e9, FAIR_START - 1, 7, False),  # the first iterations tell little
        (4.1, 10, 0, True),
        (3.9, 10, 0, False),
        (4.0 * 2.0**5 * 1.01, 5, 5, True),
        (4.0 * 2.0**5 * 0.99, 5, 5, False),  # may come near yet
    ],
)
def test_a_fit_may_be_the_farther_behind_the_more_iterations_it_has(mean_square, done, left, lost) -> None:
    assert Rival(1.0, ratio=4.0, pace=2.0).lost(mean_square, done, left) is lost
