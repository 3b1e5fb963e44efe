"""The tool on a case by its command line: what it leaves, what goes wrong, and that an interrupted run goes on."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.verdicts import __main__ as command
from experiments.verdicts import running
from experiments.verdicts.running import Outcome, diagnose, diagnose_all, has_verdict, sentence

MOTOR = Path(__file__).parents[1] / "machines" / "motor.py"
CARD = f"""\
name = "Bench motor"
sample_time = 0.01
hold = "zoh"
[channels]
voltage = {{ column = "v", unit = "V" }}
speed = {{ column = "w", unit = "rad/s" }}
[[experiment]]
name = "Steps"
file = "steps.csv"
role = "estimation"
[[experiment]]
name = "More steps"
file = "more.csv"
role = "validation"
[model]
name = "{MOTOR}:Motor"
"""


@pytest.fixture
def case(tmp_path: Path, motor_speed: Callable[..., np.ndarray]) -> Path:
    """A case in which nothing is missing, with a key that nobody may read."""
    folder = tmp_path / "cases" / "motor"
    folder.mkdir(parents=True)
    for seed, name in enumerate(("steps", "more")):
        rng = np.random.default_rng(seed)
        voltage = np.repeat(rng.uniform(-3.0, 3.0, 16), 10)
        speed = motor_speed(voltage, damping=0.03) + 0.02 * rng.standard_normal(len(voltage))
        np.savetxt(folder / f"{name}.csv", np.stack([voltage, speed], 1), delimiter=",", header="v,w", comments="")
    (folder / "dataset.toml").write_text(CARD)
    (folder / "key.json").write_text("not for the tool")
    return folder


def files(folder: Path) -> dict[str, bytes]:
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


def test_a_case_is_run_scored_by_the_command_and_passed_over_the_next_time(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, out = files(case), tmp_path / "out"
    arguments = ["run", str(case.parent), "--out", str(out), "--workers", "1", "--time-limit", "20"]
    assert command.main(arguments) == 0
    verdict = json.loads((out / "motor" / "verdict.json").read_text())
    assert f": {sentence(verdict)}" in capsys.readouterr().out
    assert json.loads((out / "motor" / "run.json").read_text())["failure"] == ""
    assert files(case) == before
    assert [f.name for f in out.iterdir()] == ["motor"]  # nothing is left of the attempt's own folder
    written = files(out)
    assert command.main(arguments) == 0
    assert "1 of 1 cases have their verdict" in capsys.readouterr().out
    assert files(out) == written
    assert command.main(["compare", str(out), str(out)]) == 0


def test_failures_are_said_counted_and_tried_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The command fails in a process of its own once; when it is run again, it gets the same answer."""
    process, ended = subprocess.run, []

    def run(*arguments: Any, **options: Any) -> subprocess.CompletedProcess[str]:
        ended.append(ended[0] if ended else process(*arguments, **options))
        return ended[0]

    monkeypatch.setattr(running.subprocess, "run", run)
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "dataset.toml").write_text('name = "no experiments"\n')
    for attempt in (1, 2):
        assert command.main(["run", str(tmp_path / "case" / "dataset.toml"), "--out", str(tmp_path / "out")]) == 1
        said = capsys.readouterr()
        assert "case" in said.err and "exit 2: " in said.out
        assert len(ended) == attempt
    assert not has_verdict(tmp_path / "out" / "case")
    assert json.loads((tmp_path / "out" / "case" / "run.json").read_text())["failure"].startswith("exit 2: ")


def test_a_case_that_does_not_end_is_given_up(case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "GRACE", -5.99)
    outcome = diagnose(case / "dataset.toml", tmp_path / "out", 10.0)
    assert outcome.failure.startswith("no verdict after")


def test_what_has_not_begun_is_left_where_the_user_interrupts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def answer(card: Path, out: Path, limit: float | None, *, threads: int) -> Outcome:
        asked.append(out.name)
        return Outcome(0.0, "said")

    def interrupted(name: str, outcome: Outcome) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(running, "diagnose", answer)
    cards = {f"c{k}": tmp_path / "dataset.toml" for k in range(50)}
    with pytest.raises(KeyboardInterrupt):
        diagnose_all(cards, tmp_path / "out", workers=1, time_limit=None, tell=interrupted)
    assert len(asked) < 50


@pytest.mark.parametrize(("workers", "threads"), [(1, "4"), (2, "2"), (3, "1"), (9, "1")])
def test_cases_side_by_side_share_the_cores(
    workers: int, threads: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[str] = []

    def run(command: list[str], *, env: dict[str, str], **others: object) -> subprocess.CompletedProcess[str]:
        given.append(env["OMP_NUM_THREADS"])
        return subprocess.CompletedProcess(command, 2, "", "stopped here")

    monkeypatch.setattr(running, "allowed_cores", lambda: 4)
    monkeypatch.setattr(running.subprocess, "run", run)
    cards = dict.fromkeys("ab", tmp_path / "dataset.toml")
    diagnose_all(cards, tmp_path / "out", workers=workers, time_limit=None, tell=lambda name, outcome: None)
    assert given == [threads, threads]
