"""`greybox export`: from a checkpoint to files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.cli import app
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.stored import attachment_json

AROUND = Surroundings({"input": Range(-3.0, 3.0, 1.7)}, {"input": "V"}, "V", 0.01)
VALUES = {"J": 0.02, "k": 0.1, "b": 0.05, "actuator.actuator_deadzone.half_width": 0.4}
UNITS = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad", "actuator.actuator_deadzone.half_width": "V"}


@pytest.fixture
def bench(motor_folder: Callable[..., Path]) -> Path:
    """The motor's folder with a checkpoint of a dead zone in `results`."""
    folder = motor_folder()
    effects = [attachment_json(Attachment("actuator", ActuatorDeadzone()), AROUND)]
    model = f"{folder.resolve()}/my_motor.py:Motor"
    save_checkpoint(folder / "results" / "model", Checkpoint(model, "Motor", VALUES, UNITS, effects))
    return folder


@pytest.mark.parametrize(("to", "files"), [("c", ["Motor.h", "Motor.c", "example.c"]), ("torch", ["Motor.py"])])
def test_from_results(bench: Path, to: str, files: list[str]) -> None:
    arguments = ["export", str(bench / "results"), "--to", to, "--dataset", str(bench / "dataset.toml"), "--json"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert told["schema"] == "greybox-export/1"
    assert told["files"] == [str(bench / "results" / to / name) for name in files]
    assert told["step"] == 0.01
    assert {
        "kind": "switch",
        "name": "actuator.actuator_deadzone.share",
        "unit": "",
        "value": 1.0,
        "description": "whether actuator.actuator_deadzone acts: 1, or 0 where it does not",  # seen: none
    } in told["variables"]
    assert "0.4" in (bench / "results" / to / files[-1 if to == "torch" else 1]).read_text()


def test_a_model_is_named_by_the_user(bench: Path, tmp_path: Path) -> None:
    """A model file that only a checkpoint names is never run."""
    stem = str(bench / "results" / "model")
    done = CliRunner().invoke(app, ["export", stem, "--to", "c"])
    assert done.exit_code == 2
    assert "a model file is run only where you name it yourself" in done.stderr
    assert "or --dataset of a command that has it" in done.stderr
    named = ["--model", f"{bench / 'my_motor.py'}:Motor", "--out", str(tmp_path / "out"), "--name", "drive"]
    done = CliRunner().invoke(app, ["export", stem, "--to", "c", *named])
    assert done.exit_code == 0, done.output
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["drive.c", "drive.h", "example.c"]
    # steps may be too long, and nothing said so
    assert "0.01 s is the sample time that effects were found with, and inputs are held" in " ".join(
        done.output.split()
    )
    asked = CliRunner().invoke(app, ["export", stem, "--to", "c", *named, "--step", "0.005", "--json"])
    assert json.loads(asked.stdout)["warnings"] == []


def test_wrong_use(bench: Path) -> None:
    for arguments, message in (
        ([str(bench / "results"), "--to", "ada"], "--to ada: expected one of"),  # not that --model is wanted, too
        ([str(bench / "nowhere"), "--to", "c"], "no such file"),
        (
            [str(bench / "results"), "--to", "ada", "--model", f"{bench / 'my_motor.py'}:Motor"],
            "--to ada: expected one of",
        ),
    ):
        done = CliRunner().invoke(app, ["export", *arguments])
        assert done.exit_code == 2
        assert message in done.stderr


def test_a_snippet(bench: Path) -> None:
    """The dead zone has no element in MJCF: the file says so, and so does the terminal."""
    arguments = ["export", str(bench / "results"), "--to", "mjcf", "--dataset", str(bench / "dataset.toml")]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    file = bench / "results" / "mjcf" / "Motor_mjcf.xml"
    assert "actuator.actuator_deadzone: Small inputs do nothing" in file.read_text()
    assert "actuator.actuator_deadzone: Small inputs do nothing" in done.stderr + done.stdout
    told = json.loads(CliRunner().invoke(app, [*arguments, "--json"]).stdout)
    assert [row["effect"] for row in told["not_said"]] == ["actuator.actuator_deadzone"]
