"""Stopping a search at any point with the best that it has found.

A stage of the search is a generator. It yields every complete state that it holds better than the one before, and returns the last. A
stage that only tries something runs another with :func:`result_of`, and yields what came of it once it has proved better. So whatever
interrupts the search, the state yielded last is the answer.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TypeVar

State = TypeVar("State")
Stage = Generator[State, None, State]


class TimeIsUp(Exception):
    """The time limit has passed."""


@dataclass(frozen=True)
class Deadline:
    """The time ``at`` (s, by :func:`time.perf_counter`) at which work is to stop."""

    at: float = math.inf

    @staticmethod
    def after(seconds: float | None) -> Deadline:
        """So many seconds from now; never where None."""
        return Deadline() if seconds is None else Deadline(time.perf_counter() + seconds)

    @property
    def passed(self) -> bool:
        return time.perf_counter() > self.at

    def check(self) -> None:
        """Asked wherever a longer piece of work begins.

        Raises:
            TimeIsUp: the deadline has passed.
        """
        if self.passed:
            raise TimeIsUp


def result_of(stage: Stage[State]) -> State:
    """What a stage returns, nothing of what it yields before."""
    while True:
        try:
            next(stage)
        except StopIteration as ended:
            return ended.value


def only_if(stage: Stage[State], accepted: Callable[[State], bool]) -> Stage[State]:
    """A stage of which only those states are yielded that are ``accepted``; it returns its last state whether it is or not."""
    while True:
        try:
            state = next(stage)
        except StopIteration as ended:
            return ended.value
        if accepted(state):
            yield state


def best_so_far(stage: Stage[State], begun: State) -> tuple[State, bool]:
    """What a stage returns, or, where the deadline or Ctrl-C stops it, what it yielded last (``begun`` where nothing); whether it ended."""
    best = begun
    try:
        while True:
            best = next(stage)
    except StopIteration as ended:
        return ended.value, True
    except (TimeIsUp, KeyboardInterrupt):
        return best, False


def or_else(work: Callable[[], State], otherwise: Callable[[], State]) -> tuple[State, bool]:
    """What ``work`` gives or, where Ctrl-C stops it, what ``otherwise`` gives; whether it was not stopped."""
    try:
        return work(), True
    except (TimeIsUp, KeyboardInterrupt):
        return otherwise(), False
