"""How far a fleet has come: counts, throughput and time left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from greybox_torch.fleets.row import Row


@dataclass(frozen=True)
class Progress:
    """``done`` of ``total`` data sets, ``kept`` of them from an earlier run and ``failed`` without a verdict, after so many ``seconds``."""

    total: int
    done: int = 0
    kept: int = 0
    failed: int = 0
    seconds: float = 0.0
    last: Row | None = None

    def after(self, row: Row, kept: bool, seconds: float) -> Progress:
        """With one more row."""
        return Progress(
            self.total, self.done + 1, self.kept + kept, self.failed + (row.failed and not kept), seconds, row
        )

    @property
    def rate(self) -> float:
        """Data sets diagnosed per second; those of an earlier run say nothing about that. Zero where it is not known yet."""
        return (self.done - self.kept) / self.seconds if self.seconds > 0.0 else 0.0

    @property
    def seconds_left(self) -> float | None:
        """By the rate so far, if all that is left has to be diagnosed; None where it is not known yet."""
        return (self.total - self.done) / self.rate if self.rate > 0.0 else None


Tell = Callable[[Progress], None]
