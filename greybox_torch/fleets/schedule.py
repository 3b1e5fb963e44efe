"""Sharing out the data sets: as many at once as there are threads, what a lost worker had once more, and what ends workers told apart."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar

from greybox_torch.errors import UserError
from greybox_torch.fleets.job import Job

if TYPE_CHECKING:
    from distributed import Client

Done = TypeVar("Done")


class Killed:
    """In the place of a result: the worker processes that had the data set ended, also while it was the only one under way."""


def share_out(client: Client, jobs: Iterable[Job], work: Callable[[Job], Done]) -> Iterator[tuple[Job, Done | Killed]]:
    """Results of ``work`` as they come.

    No more jobs are with the scheduler than the workers have threads, however many there are. Dask begins a job once more whose worker
    was lost. Where several workers of one job are lost, or more jobs than the guilty one were on them, the suspects run once more at the
    end, one by one: one that ends its workers then is given as :class:`Killed`.

    Args:
        work: a function that workers can import. What it raises ends all; it should raise nothing.

    Raises:
        UserError: the scheduler is gone.
    """
    suspects: list[Job] = []
    for job, done in _side_by_side(client, iter(jobs), work, most=None):
        if isinstance(done, Killed):
            suspects.append(job)
        else:
            yield job, done
    yield from _side_by_side(client, iter(suspects), work, most=1)


def _side_by_side(
    client: Client, jobs: Iterator[Job], work: Callable[[Job], Done], most: int | None
) -> Iterator[tuple[Job, Done | Killed]]:
    from distributed import CancelledError, Future, KilledWorker, as_completed

    under_way: dict[Any, Job] = {}
    waiting = as_completed(loop=client.loop)

    def top_up() -> None:
        threads: Any = client.nthreads()  # those that there are now
        room = (most or max(1, sum(threads.values()))) - len(under_way)
        for job in islice(jobs, max(0, room)):
            future = client.submit(work, job, pure=False)
            under_way[future.key] = job
            waiting.add(future)

    top_up()
    for future in waiting:
        assert isinstance(future, Future)
        try:
            done: Done | Killed = future.result()
        except KilledWorker:
            done = Killed()
        except CancelledError:
            raise UserError("the scheduler is gone; the same command goes on from what is done") from None
        job = under_way.pop(future.key)
        future.release()
        top_up()
        yield job, done
