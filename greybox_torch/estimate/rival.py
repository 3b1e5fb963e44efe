"""When one of several fits of the same is given up."""

from __future__ import annotations

from dataclasses import dataclass

FAIR_START = 3
"""Iterations that every start has before it is compared with others: it may be far off and come near at once."""


@dataclass(frozen=True)
class Rival:
    """A fit of mean squared error ``mean_square`` that another one competes with: while that has ``left`` iterations to go it may be
    ``ratio`` times as far behind, and ``pace`` times more for every iteration; one that is farther behind is given up.
    """

    mean_square: float
    ratio: float
    pace: float

    def lost(self, mean_square: float, done: int, left: int) -> bool:
        """Whether a fit is given up after ``done`` iterations."""
        return done >= FAIR_START and mean_square > self.mean_square * self.ratio * self.pace**left
