"""The workers of a fleet: Dask's, on this machine or wherever a scheduler has some."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from greybox_torch import __version__
from greybox_torch.errors import ArgumentError, UserError

if TYPE_CHECKING:
    from distributed import Client

EXTRA = ("dask", "distributed", "ruptures")
WAIT = 30.0
"""Seconds to wait for a scheduler, and for its first worker."""
START = 5.0
"""Seconds that a worker process takes to start, at most."""
LIVES = 0
"""Times that Dask begins a data set once more whose worker process ended, on the cluster that is started here; the schedule does, alone."""


def check_installed() -> None:
    """Raises UserError where the extra `fleet` is not installed."""
    lacking = [name for name in EXTRA if find_spec(name) is None]
    if lacking:
        raise UserError(
            f"a fleet needs {', '.join(lacking)}, not installed here; expected: pip install 'greybox_torch[fleet]'"
        )


@dataclass(frozen=True)
class Workers:
    """What shares out the work; ``restore`` is called now and then, and starts once more what is to be there and is gone."""

    client: Client
    restore: Callable[[], None] = lambda: None

    @property
    def threads(self) -> int:
        """Those that there are now."""
        there: Any = self.client.nthreads()
        return sum(there.values())


@contextmanager
def connected(scheduler: str | None, workers: int, folders: list[Path]) -> Iterator[Workers]:
    """The workers of the scheduler at that address; of a cluster on this machine, gone at the end, where it is None.

    Args:
        workers: processes of the cluster on this machine, one thread each.
        folders: what workers elsewhere have to see under the same path as this machine does.

    Raises:
        ArgumentError: there is no scheduler at the address, it has no workers, or they have another version of this package or see other
            files.
    """
    check_installed()
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what becomes of a worker is told in the table
    if scheduler is None:
        with _local(workers) as here:
            yield here
        return
    from distributed import Client

    try:
        client = Client(scheduler, timeout=WAIT, set_as_default=False)
    except (OSError, ValueError) as error:  # TimeoutError is an OSError
        raise ArgumentError("scheduler", scheduler, f"no answer ({error}); expected tcp://host:port") from None
    with client:
        _check_workers(client, scheduler, folders)
        yield Workers(client)


@contextmanager
def _local(workers: int) -> Iterator[Workers]:
    from dask.config import set as configured
    from distributed import Client, LocalCluster

    from greybox_torch.fleets.worker_process import ProcessOfOurs

    alone: dict[str, Any] = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), 1)
    own = {"distributed.scheduler.allowed-failures": LIVES, "distributed.nanny.pre-spawn-environ": alone}
    with (
        configured(own),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        client.register_plugin(ProcessOfOurs())
        started: Any = cluster
        here = Workers(client, lambda: None if here.threads >= workers else started.scale(workers))
        yield here
        # Dask fails to end a worker that takes the place of a lost one and is only being started.
        with suppress(TimeoutError):
            client.wait_for_workers(workers, timeout=START)


def _check_workers(client: Client, scheduler: str, folders: list[Path]) -> None:
    """Workers elsewhere can do the work."""
    try:
        client.wait_for_workers(1, timeout=WAIT)
    except TimeoutError:
        raise ArgumentError("scheduler", scheduler, f"has no worker after {WAIT:.0f} s; expected some") from None
    try:
        seen: Any = client.run(look_around, folders)
    except ImportError as error:
        raise ArgumentError("scheduler", scheduler, f"its workers lack this package ({error})") from None
    for worker, (version, missing) in seen.items():
        if version != __version__:
            problem = f"worker {worker} has greybox_torch {version}; expected {__version__}, as here"
            raise ArgumentError("scheduler", scheduler, problem)
        if missing:
            problem = (
                f"worker {worker} does not see {missing[0]}; expected the folders of this machine, under the same path"
            )
            raise ArgumentError("scheduler", scheduler, problem)


def look_around(folders: list[Path]) -> tuple[str, list[Path]]:
    """Asked of a worker: the version of this package there, and which of the folders it does not see."""
    return __version__, [folder for folder in folders if not folder.is_dir()]
