"""Independent pieces of work on all cores at once.

A refit is a chain of short passes with a little Python between them: two refits beside one another keep two cores busier than two
threads in every pass, which have to be woken and waited for each time.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from functools import partial
from typing import TypeVar

from greybox_torch.cores import allowed_cores
from greybox_torch.deadline import check_time, until

Result = TypeVar("Result")

_here = threading.local()


class _Team:
    """Tasks beside one another, and the cores that they share."""

    def __init__(self, tasks: int, cores: int) -> None:
        self._unfinished, self._cores, self._lock = tasks, cores, threading.Lock()

    def finish_one(self) -> None:
        with self._lock:
            self._unfinished -= 1

    @property
    def share(self) -> int:
        """Cores for each task: one, until fewer are unfinished than there are cores."""
        return max(1, self._cores // max(1, self._unfinished))


def threads() -> int:
    """Threads that a single pass may use: all cores, within :func:`side_by_side` those that no other task needs any more."""
    team: _Team | None = getattr(_here, "team", None)
    return cores() if team is None else team.share


def cores() -> int:
    """Cores that the present thread may use: one within :func:`side_by_side`, else all of this process (or what OMP_NUM_THREADS says)."""
    if getattr(_here, "team", None) is not None:
        return 1
    first = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()  # of nested threads, the outer ones
    return int(first) if first.isdecimal() and int(first) else allowed_cores()


def side_by_side(tasks: Iterable[Callable[[], Result]]) -> list[Result]:
    """Results of independent ``tasks``, in their order.

    Where one raises, or Ctrl-C interrupts, what has not begun is left undone, what has ends at its next pass, and the exception goes on.
    """
    tasks, available = list(tasks), cores()
    workers = min(available, len(tasks))
    if workers < 2:
        return [task() for task in tasks]
    team, given_up = _Team(len(tasks), available), threading.Event()
    pool = ThreadPoolExecutor(workers, initializer=partial(_join, team))

    def begun(task: Callable[[], Result]) -> Result:
        check_time()  # before it says that it has begun
        try:
            return task()
        except BaseException:
            given_up.set()  # here: the thread that waits for results may be slower than the next task
            raise
        finally:
            team.finish_one()

    try:
        with until(given_up.is_set):  # a context of its own for each, with the deadlines of the present one
            waiting = [pool.submit(copy_context().run, begun, task) for task in tasks]
        return [each.result() for each in waiting]
    except BaseException:
        given_up.set()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _join(team: _Team) -> None:
    _here.team = team
