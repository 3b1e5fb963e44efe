"""Sharing out the data sets: as many at once as there are threads, what a lost worker had once more, and what ends workers told apart."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from queue import Empty, Queue
from typing import TYPE_CHECKING, Any, TypeVar

from greybox_torch.errors import UserError
from greybox_torch.fleets.job import Job

if TYPE_CHECKING:
    from greybox_torch.fleets.cluster import Workers

TICK = 2.0
"""Seconds after which, with nothing finished, it is seen to that there are workers."""
Done = TypeVar("Done")


class Killed:
    """In the place of a result: the worker processes that had the data set ended, also while it was the only one under way."""


def share_out(
    workers: Workers, jobs: Iterable[Job], work: Callable[[Job], Done]
) -> Iterator[tuple[Job, Done | Killed]]:
    """Results of ``work`` as they come.

    No more jobs are with the scheduler than the workers have threads, however many there are. A job whose worker was lost is begun once
    more, by Dask (as often as its configuration says) or here: at the end, when no other is under way. One that ends its workers then as
    well is given as :class:`Killed`.

    Args:
        work: a function that workers can import. What it raises ends all; it should raise nothing.

    Raises:
        UserError: the scheduler is gone.
    """
    suspects: list[Job] = []
    for job, done in _side_by_side(workers, iter(jobs), work, most=None):
        if isinstance(done, Killed):
            suspects.append(job)
        else:
            yield job, done
    yield from _side_by_side(workers, iter(suspects), work, most=1)


def _side_by_side(
    workers: Workers, jobs: Iterator[Job], work: Callable[[Job], Done], most: int | None
) -> Iterator[tuple[Job, Done | Killed]]:
    from distributed import CancelledError, KilledWorker

    under_way: dict[Any, Job] = {}
    finished: Queue[Any] = Queue()

    def top_up() -> None:
        room = (most or max(1, workers.threads)) - len(under_way)
        for job in islice(jobs, max(0, room)):
            future = workers.client.submit(work, job, pure=False)
            under_way[future] = job
            future.add_done_callback(finished.put)

    top_up()
    while under_way:
        try:
            future = finished.get(timeout=TICK)
        except Empty:
            workers.restore()
            top_up()
            continue
        try:
            done: Done | Killed = future.result()
        except KilledWorker:
            done = Killed()
        except CancelledError:
            raise UserError("the scheduler is gone; the same command goes on from what is done") from None
        job = under_way.pop(future)
        top_up()
        yield job, done
