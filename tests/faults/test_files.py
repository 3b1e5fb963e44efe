"""Faults in recordings, in places where files are expected, and on the command line."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from greybox_torch.cli import app
from tests.faults.conftest import CSV

Answer = Callable[..., str]

LINES = CSV.splitlines()


def line(number: int, text: str) -> str:
    """The recording with another text in a line, which counts from 1."""
    return "\n".join([*LINES[: number - 1], text, *LINES[number:]]) + "\n"


RECORDINGS = [
    ("", "a.csv: is empty (0 bytes); expected a recording"),
    ("u,y\n", "has 0 samples; expected at least 10"),
    ("\n".join(LINES[:10]), "has 9 samples; expected at least 10"),
    ("u\n1\n2\n", 'no column "y"; found u'),
    ("u,u,y\n1,2,3\n", 'line 1: 2 columns are named "u"'),
    (line(5, "1"), "line 5: found 1 cell(s), expected 2"),
    (line(5, "1,2,3"), "line 5: found 3 cell(s), expected 2"),
    (line(5, "abc,1"), 'line 5, column "u": found "abc", expected a number'),
    (line(5, "1_000,1"), 'line 5, column "u": found "1_000"'),
    (line(5, "\u0661,1"), 'line 5, column "u": found "\u0661"'),
    (line(5, "0x1F,1"), 'line 5, column "u": found "0x1F"'),
    (line(5, "1 000,1"), 'line 5, column "u": found "1 000"'),
    (line(5, "1e5000,1"), 'line 5, column "u", sample 3 (the first is 0): found inf'),
    (line(5, "-inf,1"), "found -inf, expected a finite number"),
    (line(5, "1e150,1"), "found 1e+150, expected a number of at most 1e+100"),
    (line(5, "OVER,1"), 'found "OVER", expected a number'),
    (line(5, '"1,1'), "line 5: not comma-separated values: a quotation mark is opened here and not closed"),
    (line(5, "1," + "9" * 200_000), "a cell of more than 131072 characters"),
    (line(5, "=1+1,1"), 'found "=1+1"'),
    (line(2, "V,deg/s"), 'column "y" in "deg/s", the card says "rad/s"'),
    ("u,y\n" + ",1\n" * 80, 'channel "voltage": all 80 samples are missing'),
    ("u;y\n" + "1,5;2.5\n" * 80, 'found "2.5", expected a number'),
    ("{}", 'no column "u"'),
    ("\x89PNG\r\n\x1a\n" + "\x00" * 100, 'no column "u"'),
    ("<html><body>404</body></html>", 'no column "u"'),
    ("u,y\n" + "a,b\n" * 5, 'found "a"'),
]  # fmt: skip


@pytest.mark.parametrize(("content", "message"), RECORDINGS, ids=range(len(RECORDINGS)))
def test_recording(spoilt: Path, answer: Answer, content: str, message: str) -> None:
    (spoilt / "a.csv").write_text(content)
    answer("inspect", "dataset.toml", message=message)


STAMPS = [
    ("0.03", "0.02", "found 0.02 s after 0.02 s"),
    ("0.03", "0.01", "found 0.01 s after 0.02 s"),
    ("0.03", "", "the time stamp is missing"),
    ("0.03", "nan", "the time stamp is missing"),
    ("0.03", "inf", "found inf"),
    ("0.03", "soon", 'found "soon"'),
    ("0.00", "1e101", "found 1e+101"),
]


@pytest.mark.parametrize(("old", "new", "message"), STAMPS)
def test_time_stamps(spoilt: Path, answer: Answer, old: str, new: str, message: str) -> None:
    rows = [f"{new if f'{0.01 * k:.2f}' == old else f'{0.01 * k:.2f}'},{row}" for k, row in enumerate(LINES[1:])]
    (spoilt / "a.csv").write_text("\n".join(["t,u,y", *rows]) + "\n")
    card = spoilt / "dataset.toml"
    card.write_text(card.read_text().replace("sample_time = 0.01", 'time = "t"'))
    answer("inspect", "dataset.toml", message=message)


@pytest.mark.parametrize(
    ("name", "expected"),
    [("dataset.toml", "dataset.toml"), ("a.csv", "a.csv"), ("my_motor.py", "my_motor.py")],
)
def test_what_is_no_file(spoilt: Path, answer: Answer, name: str, expected: str) -> None:
    (spoilt / name).unlink()
    answer("inspect", "dataset.toml", message="no such file")
    (spoilt / name).symlink_to(name)
    answer("inspect", "dataset.toml", message="Too many levels of symbolic links")
    (spoilt / name).unlink()
    os.mkfifo(spoilt / name)
    answer("inspect", "dataset.toml", message=f"{expected}: is a pipe")
    (spoilt / name).unlink()
    (spoilt / name).symlink_to("/dev/zero")
    answer("inspect", "dataset.toml", message=f"{expected}: is a device")
    (spoilt / name).unlink()
    (spoilt / name).mkdir()
    answer("inspect", "dataset.toml", message=expected)


COMMANDS = [
    (["inspect", "nowhere.toml"], "nowhere.toml: no such file"),
    (["inspect", "nowhere.toml"], "expected a data card"),
    (["inspect", "."], "is a folder; expected the card in it, dataset.toml"),
    (["inspect", ".."], "..: is a folder without dataset.toml; expected a data card"),
    (["fit", "datset.toml"], 'no such file (did you mean "dataset.toml"?)'),
    (
        ["diagnose", "a.csv"],
        "a.csv: is a recording; expected a data card, dataset.toml (`greybox card a.csv` writes one)",
    ),
    (
        ["diagnose", "my_motor.py"],
        'my_motor.py: is a model; expected a data card, dataset.toml, which names it: [model] name = "my_motor.py:<its class>"',
    ),
    (
        ["fit", "dataset.toml", "--model", "my_motor.py"],
        "is a file; expected the class in it as well, such as my_motor.py:Motor",
    ),
    (["fit", "dataset.toml", "--model", "my_motor.py:motor"], "class 'motor' is not defined; it defines Motor"),
    (["fit", "dataset.toml", "--profile", "j"], 'did you mean "J"?'),
    (["diagnose", "dataset.toml", "--time-limit", "1min"], "--time-limit"),
    (["diagnose", "dataset.toml", "--settings", "s.toml"], "s.toml: no such file; expected settings of a diagnosis"),
    (["compare", "dataset.toml", "dataset.toml"], "checkpoint dataset.toml: is a data card, no checkpoint"),
    (["design", "results"], "results: no such folder; expected the folder of results of greybox diagnose"),
    (["design", "dataset.toml"], "dataset.toml: is a file; expected the folder of results of greybox diagnose"),
    (["export", "results", "--to", "c"], "checkpoint results: no such file or folder"),
    (["fleet", "nothing"], "nothing: no such folder or file; expected a folder of data sets, a pattern, or a card"),
    (["fleet", ".", "--workers", "0"], "--workers"),
    (["train", "dataset.toml", "--signals", "speed;load"], "speed;load"),
    (["card"], "Missing argument"),
    (["card", "dataset.toml"], 'no reader for files ending in ".toml"'),
    (["card", "."], ".: is a folder; expected a recording in it"),
    (["card", "a.csv", "--out", "b.csv"], "--out b.csv: expected a file that ends in .toml"),
    (["card", "b.csv"], 'b.csv: no such file (did you mean "a.csv"?)'),
    (["diagnos", "dataset.toml"], "No such command"),
    (["inspect", "a\0b.toml"], "embedded null byte"),
    (["inspect", "x" * 400], "File name too long"),
    (["inspect", "dataset.toml", "--model", "nowhere.py:Motor"], "nowhere.py: no such file"),
    (["inspect", "dataset.toml", "--model", "robot"], "model 'robot' is unknown"),
    (["inspect", "dataset.toml", "--model", "a.csv:Motor"], "is unknown"),
    (["inspect", "dataset.toml", "--model", "robot_arm"], "robot_arm"),
    (["inspect", "dataset.toml", "--out", "a.csv"], "a.csv"),
    (["inspect", "dataset.toml", "--out", "a.csv/inside"], "a.csv"),
    (["inspect", "dataset.toml", "--out", "a\0b"], "embedded null byte"),
    (["inspect", "dataset.toml", "--out", "x" * 400], "cannot be written"),
    (["simulate", "dataset.toml", "--device", "quantum"], "quantum"),
    (["simulate", "dataset.toml", "--device", "cuda:99"], "cuda:99"),
    (["simulate", "dataset.toml", "--precision", "half"], "half"),
    (["simulate", "dataset.toml", "--seed", "-1"], "--seed"),
    (["simulate", "dataset.toml", "--seed", "x"], "--seed"),
    (["fit", "dataset.toml", "--starts", "0"], "--starts"),
    (["fit", "dataset.toml", "--profile", "mass"], "mass"),
    (["residuals", "dataset.toml", "--checkpoint", ".."], "not the name of a file"),
    (["diagnose", "dataset.toml", "--time-limit", "0"], "--time-limit"),
    (["train", "dataset.toml", "--net", "magic"], "magic"),
    (["train", "dataset.toml", "--port", "gear"], "gear"),
    (["train", "dataset.toml", "--resume"], "no such file"),
    (["explode"], "No such command"),
    (["inspect"], "Missing argument"),
    (["inspect", "dataset.toml", "--colour"], "No such option"),
]


@pytest.mark.parametrize(
    ("arguments", "message"), COMMANDS, ids=[" ".join(c[0])[:60].replace("\0", "0") for c in COMMANDS]
)
def test_command_line(answer: Answer, arguments: list[str], message: str) -> None:
    answer(*arguments, message=message)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("inspect", "is a folder without dataset.toml; expected a data card, such as cards/a.toml and cards/b.toml"),
        ("design", "expected results of greybox diagnose (`greybox diagnose CARD --out cards` writes them)"),
    ],
)
def test_a_folder_of_something_else(spoilt: Path, answer: Answer, command: str, message: str) -> None:
    (spoilt / "cards").mkdir()
    for name in ("a.toml", "b.toml"):
        (spoilt / "cards" / name).write_text("")
    answer(command, "cards", message=message)


FIRST_STEPS = [
    (["new", "my_motor"], "my_motor.py: is there already and is not overwritten"),
    (["new", "drive", "--like", "moter"], 'did you mean "motor"?'),
    (["card", "a.csv"], "dataset.toml: is there already and is not overwritten"),
    (["check", "a.csv"], "a.csv: is a recording; expected a data card, dataset.toml (`greybox card a.csv` writes one)"),
]


@pytest.mark.parametrize(("arguments", "message"), FIRST_STEPS, ids=[" ".join(c[0]) for c in FIRST_STEPS])
def test_first_steps(spoilt: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str) -> None:
    """These commands write beside the files, so nothing is said of a folder for results."""
    monkeypatch.chdir(spoilt)
    before = {file: file.read_bytes() for file in spoilt.iterdir()}
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2 and message in " ".join(done.stderr.split())
    assert {file: file.read_bytes() for file in spoilt.iterdir()} == before
