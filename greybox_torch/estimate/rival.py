"""When one of several fits of the same is given up."""

from __future__ import annotations

from dataclasses import dataclass

FAIR_START = 3
"""Iterations that every start has before it is compared with others: it may be far off and come near at once."""


@dataclass(frozen=True)
class Rival:
    """A fit of mean squared error ``mean_square`` that another one competes with; one that would not come level with it in the iterations
    that are left is given up, were every one of them to gain as much as ``pace`` times its last.
    """

    mean_square: float
    pace: float

    def lost(self, mean_square: float, change: float, done: int, left: int) -> bool:
        """Whether a fit is given up after ``done`` iterations, the last of which lowered its cost by the share ``change``."""
        return done >= FAIR_START and mean_square * (1.0 - change) ** (self.pace * left) > self.mean_square
