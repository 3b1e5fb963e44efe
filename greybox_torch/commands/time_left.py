"""How long a computation still takes, by how fast it has gone on so far."""

from __future__ import annotations

from statistics import median

FIRST_STEPS = 5
"""Steps from which on a time is told."""


class TimeLeft:
    """Told the share that is done, step by step, says how many seconds are left.

    The median of the seconds for each share counts: what came before the first step does not, nor do single steps that take long, or
    that skip what is not needed any more.
    """

    def __init__(self) -> None:
        self._before: tuple[float, float] | None = None
        self._rates: list[float] = []

    def after(self, now: float, share: float) -> float | None:
        """Seconds left at the time ``now`` (s), with ``share`` of the work done; None where that cannot be told."""
        before = self._before
        if before is None or share != before[1]:
            self._before = (now, share)
        if before is not None and share < before[1]:  # begun anew
            self._rates = []
        elif before is not None and 0.0 < before[1] < share < 1.0:
            self._rates.append((now - before[0]) / (share - before[1]))
        if len(self._rates) < FIRST_STEPS or not share < 1.0:
            return None
        return median(self._rates) * (1.0 - share)


def told_left(seconds: float | None) -> str:
    """In words; "" where it is not known. What follows the epochs of a training is not among it."""
    return "" if seconds is None else f"about {max(seconds, 1.0):.0f} s left for the epochs"
