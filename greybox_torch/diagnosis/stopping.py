"""Stopping a search at any point with the best that it has found.

A stage of the search is a generator. It yields every complete state that it holds better than the one before, and returns the last. A
stage that only tries something runs another with :func:`result_of`, and yields what came of it once it has proved better. So whatever
interrupts the search, the state yielded last is the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TypeVar

from greybox_torch.deadline import TimeIsUp

State = TypeVar("State")
Stage = Generator[State, None, State]


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


def best_so_far(
    stage: Stage[State], begun: State, better: Callable[[State], None] = lambda state: None
) -> tuple[State, bool]:
    """What a stage returns, or, where the deadline or Ctrl-C stops it, what it yielded last (``begun`` where nothing); whether it ended.

    ``better`` is told every state that is yielded.
    """
    best = begun
    try:
        while True:
            best = next(stage)
            better(best)
    except StopIteration as ended:
        return ended.value, True
    except (TimeIsUp, KeyboardInterrupt):
        return best, False


def or_else(work: Callable[[], State], otherwise: Callable[[], State]) -> tuple[State, bool]:
    """What ``work`` gives or, where the deadline or Ctrl-C stops it, what ``otherwise`` gives; whether it was not stopped."""
    try:
        return work(), True
    except (TimeIsUp, KeyboardInterrupt):
        return otherwise(), False
