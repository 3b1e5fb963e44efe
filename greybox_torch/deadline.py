"""When work has to stop: whatever computes within :func:`until` ends at its next pass once the time has come."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass


class TimeIsUp(Exception):
    """The time has come at which the present work had to stop."""


@dataclass(frozen=True)
class Deadline:
    """The time ``at`` (s, by :func:`time.perf_counter`) at which work is to stop."""

    at: float = math.inf

    @staticmethod
    def after(seconds: float | None) -> Deadline:
        """So many seconds from now; never where None."""
        return Deadline() if seconds is None else Deadline(time.perf_counter() + seconds)

    @property
    def left(self) -> float:
        """Seconds until then; negative where it has passed."""
        return self.at - time.perf_counter()

    @property
    def limited(self) -> bool:
        """Whether there is such a time."""
        return math.isfinite(self.at)

    @property
    def passed(self) -> bool:
        return time.perf_counter() > self.at


_STOPS: ContextVar[tuple[Callable[[], bool], ...]] = ContextVar("stops", default=())


@contextmanager
def until(stop: Callable[[], bool] | Deadline) -> Iterator[None]:
    """Work within ends with :class:`TimeIsUp` once the deadline has passed (or ``stop()`` says so), besides what stops it anyway.

    Not around the ``yield`` of a generator: the caller's work would then stop as well.
    """
    check = (lambda: stop.passed) if isinstance(stop, Deadline) else stop
    token = _STOPS.set((*_STOPS.get(), check))
    try:
        yield
    finally:
        _STOPS.reset(token)


def check_time() -> None:
    """Asked before every pass of a simulation, and wherever a longer piece of work begins.

    Raises:
        TimeIsUp: what is around this has to stop.
    """
    if any(stop() for stop in _STOPS.get()):
        raise TimeIsUp
