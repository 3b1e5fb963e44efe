"""Diagnosing many machines."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from greybox_torch.api.fleet_machine import diagnose_machine, without_a_diagnosis
from greybox_torch.api.fleet_result import FleetResult
from greybox_torch.api.plain_arguments import check_device, check_seconds, check_seed, check_told, check_whole
from greybox_torch.cores import allowed_cores
from greybox_torch.errors import ArgumentError, Kind
from greybox_torch.files import absolute
from greybox_torch.fleets import cluster
from greybox_torch.fleets.cards import find_cards
from greybox_torch.fleets.job import Choices, Job
from greybox_torch.fleets.journal import journal
from greybox_torch.fleets.killed import killed_row
from greybox_torch.fleets.progress import Progress
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.schedule import Killed, share_out
from greybox_torch.keywords import names_checked

MOST_WORKERS = 4096

Place = str | PathLike[str]


@names_checked
def fleet(
    where: Place | Iterable[Place],
    out: Place,
    *,
    model: str | None = None,
    settings: Mapping[str, Any] | Place | None = None,
    time_limit: float | None = None,
    seed: int = 0,
    device: str = "cpu",
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[Progress], None] = lambda progress: None,
) -> FleetResult:
    """Diagnose every data set below a folder, on Dask, and write the results as they come.

    The results of an earlier run into the same folder are kept where nothing that they depend on has changed:
    recordings, card, model file, settings, and the version of this package. A data set that fails is a row of the
    table like the others; it is tried again the next time. Ctrl-C ends the work: the result then has what is done, and
    says that it is not complete.

    In a program that is run as a file this has to stand under ``if __name__ == "__main__":``, as worker processes import that file.

    Args:
        where: a folder (every `dataset.toml` below it), a pattern of cards, a card, or several of these.
        out: the folder of the results: `fleet.html`, `fleet.parquet`, `fleet.jsonl`, and in a folder for each data set what `diagnose`
            writes.
        model: a name as :func:`greybox_torch.load_model` takes it; by default each card's own.
        settings: names of settings of a diagnosis with their values, or a TOML file of them; they go before those of the cards.
        time_limit: seconds after which the search on one data set stops and the best answer so far is given.
        seed: written into the verdicts; the search itself draws no random numbers.
        device: "cpu", "cuda" or "cuda:N", as the workers have it.
        workers: processes on this machine; by default one for each core that this process may use.
        scheduler: address of a Dask scheduler whose workers are to be used in their place. They have to see the same files under the same
            paths.
        progress: is told how far it has come, after every data set.

    Raises:
        UserError: nothing was found, an argument is at fault, the extra `fleet` is not installed, or results cannot be written.

    Examples:
        ``gt.fleet("machines", "results/fleet", time_limit=60).rows``
    """
    began = time.perf_counter()
    check_told("progress", progress, "a Progress")
    cluster.check_installed()
    folder = absolute(Path(fspath(out)))
    cards = find_cards([where] if isinstance(where, str | PathLike) else list(where), beside=folder)
    count = None if workers is None else check_whole("workers", workers, 1, MOST_WORKERS)
    if count is not None and scheduler is not None:
        raise ArgumentError("workers", count, "the scheduler has its own; expected one of the two")
    choices = _choices(model, settings, time_limit, seed, device if scheduler else check_device(device))
    jobs = [Job(name, card, folder / name, choices) for name, card in cards.items()]
    rows, complete = _run(jobs, scheduler, count, folder, journal(folder), partial(_tell, began, progress))
    result = FleetResult(_sorted(rows, jobs), len(jobs) - len(rows), complete, time.perf_counter() - began)
    result.save(folder)
    return result


def _run(
    jobs: list[Job],
    scheduler: str | None,
    workers: int | None,
    folder: Path,
    add: Callable[[Row], None],
    tell: Callable[[Progress, Row, bool], Progress],
) -> tuple[list[Row], bool]:
    """The rows in the order in which they came, and whether all of them did."""
    rows: list[Row] = []
    state = Progress(len(jobs))
    folders = list(dict.fromkeys([folder, *(job.card.parent for job in jobs)]))

    def come(row: Row, kept: bool, state: Progress) -> Progress:
        rows.append(row)
        add(row)
        return tell(state, row, kept)

    try:
        # Workers take seconds to start, on this machine: for nothing, where nothing has changed.
        at_once: set[str] = set()
        for name, (row, kept) in () if scheduler else _settled(jobs, workers or allowed_cores()):
            at_once.add(name)
            state = come(row, kept, state)
        left = [job for job in jobs if job.name not in at_once]
        if left:
            with cluster.connected(scheduler, min(workers or allowed_cores(), len(left)), folders) as there:
                for job, done in share_out(there, left, diagnose_machine):
                    row, kept = (killed_row(job), False) if isinstance(done, Killed) else done
                    state = come(row, kept, state)
    except KeyboardInterrupt:
        return rows, False
    return rows, True


def _settled(jobs: Sequence[Job], threads: int) -> Iterator[tuple[str, tuple[Row, bool]]]:
    """By name, what is found of the jobs for which there is nothing to be diagnosed. Files are read side by side."""
    with ThreadPoolExecutor(threads) as pool:
        for job, found in zip(jobs, pool.map(without_a_diagnosis, jobs), strict=True):
            if found is not None:
                yield job.name, found


def _tell(began: float, progress: Callable[[Progress], None], state: Progress, row: Row, kept: bool) -> Progress:
    state = state.after(row, kept, time.perf_counter() - began)
    progress(state)
    return state


def _choices(
    model: str | None, settings: Mapping[str, Any] | Place | None, time_limit: float | None, seed: int, device: str
) -> Choices:
    """What holds for all, checked before any of them is begun."""
    if model is not None and not isinstance(model, str):
        raise ArgumentError("model", Kind.of(model), 'expected a name, such as "my_motor.py:Motor"')
    reference = None  # what is imported here loads torch, which takes a second
    if model is not None:
        from greybox_torch.systems import load_model, model_reference

        reference = model_reference(load_model(model))
    named: Mapping[str, Any] = {}
    said = "settings"
    if isinstance(settings, Mapping):
        named = dict(settings)
    elif settings is not None:
        from greybox_torch.diagnosis.settings import settings_from_file

        named, said = settings_from_file(Path(settings)), fspath(settings)
    if named:
        from greybox_torch.diagnosis.settings import settings_from_mapping

        settings_from_mapping(named, said)
    return Choices(
        model=reference,
        settings=named,
        settings_from=said,
        time_limit=None if time_limit is None else check_seconds("time_limit", time_limit),
        seed=check_seed(seed),
        device=device,
    )


def _sorted(rows: list[Row], jobs: list[Job]) -> tuple[Row, ...]:
    """In the order of the data sets' names."""
    by_name = {row.dataset: row for row in rows}
    return tuple(by_name[job.name] for job in jobs if job.name in by_name)
