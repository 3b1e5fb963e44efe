"""`fleet` from the command line. The diagnosis is replaced, but for one run that does it whole in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from distributed import Client, LocalCluster
from typer.testing import CliRunner, Result

import greybox_torch as gt
from greybox_torch.api import fleet_diagnosis
from greybox_torch.cli import app
from greybox_torch.errors import NumericalError
from greybox_torch.fleets import cluster
from greybox_torch.fleets.job import Job
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.store import store
from greybox_torch.result_names import OF_A_DIAGNOSIS

Make = Callable[..., Path]
CARD = """\
machine = "{machine}"
recorded = 2026-0{month}-01
sample_time = 0.01

[channels]
voltage = {{ column = "v", unit = "V" }}

[[experiment]]
name = "Steps"
file = "steps.csv"
"""


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0") as threads,
        Client(threads, set_as_default=False) as client,
    ):
        yield client


@pytest.fixture
def done(client: Client, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Makes the workers threads of this process that diagnose nothing; the list tells which data sets they had."""

    @contextmanager
    def local(workers: int) -> Iterator[cluster.Workers]:
        assert 1 <= workers <= 8  # no more than there are data sets
        yield cluster.Workers(client)

    had: list[str] = []

    def diagnosed(job: Job, row: Row, began: float) -> Row:
        had.append(job.name)
        if job.card.parent.name == "overflows":
            raise NumericalError("the simulation overflows")
        if job.card.parent.name == "endless":
            raise MemoryError
        if job.card.parent.name == "strange":
            sys.exit(3)
        told = replace(row, answer="nothing", seconds=1.0, fit_before=98.5, fit_after=98.5, confidence=0.9)
        told = replace(told, report=f"{job.name}/report.html", fingerprint=row.fingerprint)
        store(job, told, {job.folder / name: name for name in OF_A_DIAGNOSIS})
        return told

    monkeypatch.setattr(cluster, "_local", local)
    monkeypatch.setattr(fleet_diagnosis, "diagnosed", diagnosed)
    return had


@pytest.fixture
def plant(tmp_path: Path) -> Path:
    """Three sound data sets of two machines, below `plant`."""
    for name, machine, month in (("a/spring", "a", 3), ("a/summer", "a", 6), ("b", "b", 3)):
        add(tmp_path / "plant" / name, machine, month)
    return tmp_path / "plant"


def add(folder: Path, machine: str, month: int = 1) -> None:
    folder.mkdir(parents=True)
    (folder / "dataset.toml").write_text(CARD.format(machine=machine, month=month))
    (folder / "steps.csv").write_text("v\n1\n2\n")


def fleet(plant: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["fleet", str(plant), "--out", str(plant.parent / "out"), *options])


def test_what_is_written_and_printed(plant: Path, done: list[str]) -> None:
    result = fleet(plant, "--json")
    assert result.exit_code == 0, result.stderr
    out, told = plant.parent / "out", json.loads(result.stdout)
    assert sorted(done) == ["a/spring", "a/summer", "b"]
    assert (told["schema"], told["complete"], told["waiting"]) == ("greybox-fleet/1", True, 0)
    assert [(row["dataset"], row["machine"], row["recorded"]) for row in told["machines"]] == [
        ("a/spring", "a", "2026-03-01"),
        ("a/summer", "a", "2026-06-01"),
        ("b", "b", "2026-03-01"),
    ]
    lines = [json.loads(line) for line in (out / "fleet.jsonl").read_text().splitlines()]
    assert lines == told["machines"]
    table = pq.read_table(out / "fleet.parquet").to_pylist()
    assert [row["dataset"] for row in table] == ["a/spring", "a/summer", "b"]
    assert table[0]["fit_after"] == 98.5 and table[0]["parameters"] == []
    assert 'href="a/spring/report.html"' in (out / "fleet.html").read_text()
    assert sorted(path.name for path in (out / "a" / "spring").iterdir()) == sorted([*OF_A_DIAGNOSIS, "fleet_row.json"])
    assert "3 data sets: 3 nothing missing." in result.stderr
    assert "3 of 3 done" in result.stderr


def test_a_restart_does_what_is_new_or_changed(plant: Path, done: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    fleet(plant)
    done.clear()
    with monkeypatch.context() as without_workers:
        without_workers.delattr(cluster, "connected")
        again = fleet(plant)
    assert done == [] and "(3 unchanged)" in again.stderr
    (plant / "b" / "steps.csv").write_text("v\n1\n3\n")
    add(plant / "c", "c")
    assert fleet(plant, "--json").exit_code == 0
    assert sorted(done) == ["b", "c"]
    done.clear()
    assert fleet(plant, "--time-limit", "5").exit_code == 0
    assert len(done) == 4


def test_a_data_set_that_fails_is_a_row(plant: Path, done: list[str]) -> None:
    for name in ("overflows", "endless", "strange"):
        add(plant / name, name)
    (plant / "broken").mkdir()
    (plant / "broken" / "dataset.toml").write_text("sample_time = [\n")
    (plant / "b" / "steps.csv").unlink()
    result = fleet(plant, "--json")
    assert result.exit_code == 0, result.stderr
    rows = {row["dataset"]: row for row in json.loads(result.stdout)["machines"]}
    failures = {name: row["failure"] for name, row in rows.items() if row["answer"] == "failed"}
    assert failures == {
        "b": "input",
        "broken": "input",
        "endless": "memory",
        "overflows": "numbers",
        "strange": "error",
    }
    assert "not valid TOML" in rows["broken"]["message"] and "steps.csv: no such file" in rows["b"]["message"]
    assert rows["strange"]["message"].startswith("SystemExit: 3 (")
    assert (rows["b"]["machine"], rows["b"]["recorded"]) == ("b", "2026-03-01")
    done.clear()
    (plant / "b" / "steps.csv").write_text("v\n1\n")
    fleet(plant)
    assert sorted(done) == ["b", "endless", "overflows", "strange"]  # what failed is tried again


def test_stopped(plant: Path, done: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C after the first: that one is kept, and the next run does the others."""
    whole = cluster.Workers.threads

    def interrupt(there: cluster.Workers) -> Any:
        if done:
            raise KeyboardInterrupt
        return whole.__get__(there)

    monkeypatch.setattr(cluster.Workers, "threads", property(interrupt))
    result = fleet(plant)
    assert result.exit_code == 130
    assert "stopped with 3 to go" in result.stdout or "stopped with 2 to go" in result.stdout
    assert "interrupted" in result.stderr
    assert "Stopped:" in (plant.parent / "out" / "fleet.html").read_text()
    monkeypatch.undo()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--model", "no_such"), "model 'no_such' is unknown"),
        (("--settings", "nowhere.toml"), "nowhere.toml: no such file"),
        (("--workers", "2", "--scheduler", "tcp://127.0.0.1:1"), "--workers 2: the scheduler has its own"),
        (("--device", "abacus"), "--device abacus: expected"),
    ],
)
def test_options_at_fault(plant: Path, done: list[str], options: tuple[str, ...], message: str) -> None:
    """They are told at once, before any data set is begun."""
    result = fleet(plant, *options)
    assert (result.exit_code, done) == (2, [])
    assert message in " ".join(result.stderr.split())


def test_nothing_found(tmp_path: Path) -> None:
    result = fleet(tmp_path / "nowhere")
    assert result.exit_code == 2
    assert "no such folder or file" in result.stderr


def test_from_python(plant: Path, done: list[str]) -> None:
    told: list[int] = []
    found = gt.fleet(plant, plant.parent / "out", settings={"least_gain": 0.05}, progress=lambda p: told.append(p.done))
    assert isinstance(found, gt.FleetResult)
    assert told == [1, 2, 3]
    assert [row["answer"] for row in found.rows] == ["nothing"] * 3
    assert str(found).startswith("3 data sets: 3 nothing missing.")
    assert repr(found) == "<fleet: 3 data sets: 3 nothing missing.>"
    assert "<table>" in found._repr_html_() and found.plot().axes[0].collections
    assert found.to_dict("out")["page"] == "out/fleet.html"
    with pytest.raises(gt.UserError, match="not a setting"):
        gt.fleet(plant, plant.parent / "out", settings={"least_gian": 0.05})


def test_the_same_verdict_as_one_by_one(motor_folder: Make, tmp_path: Path) -> None:
    """The real diagnosis in a worker process."""
    folder = motor_folder()
    alone = gt.diagnose(gt.load_model(f"{folder / 'my_motor.py'}:Motor"), gt.load_dataset(folder / "dataset.toml"))
    command = [sys.executable, "-m", "greybox_torch", "fleet", str(folder), "--out", str(tmp_path / "out")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    run = subprocess.run(
        [*command, "--workers", "1", "--json"],
        capture_output=True,
        text=True,
        timeout=300,
        env=environment,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    (row,) = json.loads(run.stdout)["machines"]
    assert (row["dataset"], row["answer"], row["sentence"]) == ("motor", "nothing", alone.sentence)
    assert row["parameters"]["J"]["value"] == alone.parameters["J"].value
    verdict = json.loads((tmp_path / "out" / "motor" / "verdict.json").read_text())
    timing = ("seconds", "stages")
    assert {k: v for k, v in verdict.items() if k not in timing} == {
        k: v for k, v in alone.to_dict().items() if k not in timing
    }
