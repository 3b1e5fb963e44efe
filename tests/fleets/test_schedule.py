"""Sharing out the work: nothing lost with a worker, what ends workers told apart, and never more under way than there are threads."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from distributed import Client, LocalCluster

from greybox_torch.api import fleet
from greybox_torch.errors import ArgumentError, UserError
from greybox_torch.fleets import cluster, schedule
from greybox_torch.fleets.job import Job
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.schedule import Killed, share_out


@pytest.fixture(scope="module")
def threads() -> Iterator[Client]:
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0") as both,
        Client(both, set_as_default=False) as client,
    ):
        yield client


def jobs(count: int) -> list[Job]:
    return [Job(f"p{k}", Path("dataset.toml"), Path("out")) for k in range(count)]


class UnderWay:
    """Counts the calls of `work` that run at the same time, in this process."""

    lock = threading.Lock()
    now = most = 0


def work(job: Job) -> str:
    with UnderWay.lock:
        UnderWay.now += 1
        UnderWay.most = max(UnderWay.most, UnderWay.now)
    time.sleep(0.005)
    with UnderWay.lock:
        UnderWay.now -= 1
    return job.name


def test_all_results_and_no_more_under_way_than_threads(threads: Client) -> None:
    given = 0

    def counted() -> Iterator[Job]:
        nonlocal given
        for job in jobs(12):
            given += 1
            yield job

    results = []
    for done, (job, name) in enumerate(share_out(cluster.Workers(threads), counted(), work), start=1):
        results.append((job.name, name))
        assert given <= done + 2
    assert sorted(results) == sorted((job.name, job.name) for job in jobs(12))
    assert 1 <= UnderWay.most <= 2


def test_workers_that_do_not_come_back_are_started_once_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(schedule, "TICK", 0.1)
    local: dict[str, Any] = {"threads_per_worker": 1, "processes": False, "dashboard_address": "127.0.0.1:0"}
    with LocalCluster(n_workers=0, **local) as empty, Client(empty, set_as_default=False) as client:
        there = cluster.Workers(client, lambda: empty.scale(1))
        assert there.threads == 0
        assert [name for _, name in share_out(there, jobs(2), work)] == ["p0", "p1"]


def test_no_scheduler() -> None:
    with (
        pytest.raises(ArgumentError, match="expected tcp://host:port") as error,
        cluster.connected("nowhere", 1, []),
    ):
        pass
    assert error.value.for_option().startswith("--scheduler nowhere: no answer")


def test_a_scheduler_elsewhere(threads: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is used as it is, and asked for what its workers have."""
    address = str(threads.scheduler_info()["address"])
    with cluster.connected(address, 1, [tmp_path]) as client:
        assert [name for _, name in share_out(client, jobs(3), lambda job: job.card)] == [Path("dataset.toml")] * 3
    with (
        pytest.raises(ArgumentError, match=r"does not see .*elsewhere"),
        cluster.connected(address, 1, [tmp_path / "elsewhere"]),
    ):
        pass
    monkeypatch.setattr(cluster, "look_around", lambda folders: ("0.0.0", []))
    with (
        pytest.raises(ArgumentError, match=r"has greybox_torch 0\.0\.0; expected"),
        cluster.connected(address, 1, [tmp_path]),
    ):
        pass


def test_workers_elsewhere_have_to_see_the_folder_of_every_card(monkeypatch: pytest.MonkeyPatch, job: Job) -> None:
    """Seen: the folder of the first card alone, so that the data sets of others failed one by one."""
    asked: list[Path] = []

    @contextmanager
    def connected(scheduler: str, workers: int, folders: list[Path]) -> Iterator[cluster.Workers]:
        asked.extend(folders)
        raise KeyboardInterrupt
        yield

    monkeypatch.setattr(cluster, "connected", connected)
    others = [replace(job, card=Path(card)) for card in ("/x/a.toml", "/y/b.toml", "/x/c.toml")]
    fleet._run(others, "tcp://there:1", None, Path("/out"), lambda row: None, lambda state, row, kept: state)
    assert asked == [Path("/out"), Path("/x"), Path("/y")]


def test_what_is_settled_is_told_at_once_and_kept(monkeypatch: pytest.MonkeyPatch, job: Job) -> None:
    """Seen: nothing was told before all files were read, and an interruption left a table without a row."""
    found: list[str] = []

    def settled(one: Job) -> tuple[Row, bool]:
        if one.name == "p2":
            raise KeyboardInterrupt
        return Row(one.name, str(one.card), "nothing"), True

    monkeypatch.setattr(fleet, "without_a_diagnosis", settled)
    others = [replace(job, name=name) for name in ("p0", "p1", "p2")]
    rows, complete = fleet._run(
        others, None, 1, Path("/out"), lambda row: found.append(row.dataset), lambda s, row, kept: s
    )
    assert found == [row.dataset for row in rows] == ["p0", "p1"] and not complete


def test_a_card_that_cannot_be_read_is_settled_beside_a_good_one(tmp_path: Path, job: Job) -> None:
    (tmp_path / "good.toml").write_text(
        'sample_time = 1.0\n[channels]\nu = { column = "u" }\n[[experiment]]\nname = "a"\nfile = "a.csv"\n'
    )
    (tmp_path / "bad.toml").write_text("sample_time = \n")
    both = [replace(job, name=n, card=tmp_path / f"{n}.toml", folder=tmp_path / n) for n in ("good", "bad")]
    ((name, (row, kept)),) = fleet._settled(both, 2)
    assert (name, row.answer, row.failure, kept) == ("bad", "failed", "input", False)


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "EXTRA", ("dask", "no_such_package"))
    with pytest.raises(UserError, match=r"needs no_such_package, .* pip install 'greybox_torch\[fleet\]'"):
        cluster.check_installed()


def test_workers_that_are_lost_and_one_that_ends_them(tmp_path: Path) -> None:
    """Real processes: one data set ends every worker that has it, another's worker is killed once; all others come to a result."""

    def work(job: Job) -> Any:
        import os
        import signal
        from pathlib import Path

        if job.name == "p1":
            os._exit(1)
        once = Path(job.folder) / "killed"
        if job.name == "p2" and not once.exists():
            once.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return os.environ["OMP_NUM_THREADS"], signal.getsignal(signal.SIGINT) == signal.SIG_IGN

    given = [Job(job.name, job.card, tmp_path) for job in jobs(5)]
    with cluster.connected(None, 2, []) as client:
        results = {job.name: done for job, done in share_out(client, given, work)}
    assert isinstance(results.pop("p1"), Killed)
    assert results == dict.fromkeys(("p0", "p2", "p3", "p4"), ("1", True))
    assert (tmp_path / "killed").exists()
