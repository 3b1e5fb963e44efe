"""`greybox train` from the command line, killed and taken up again among the rest."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from greybox_torch.checkpoint import load_checkpoint
from greybox_torch.cli import app
from greybox_torch.commands import train as train_command

Make = Callable[..., Path]
QUICK = ("--net", "residual", "--port", "actuator", "--units", "4", "--epochs", "5")
FILES = ["model.json", "model.safetensors", "train.json", "training.safetensors"]
EXPLAINED = sorted([*FILES, "learned.png", "named.json", "named.safetensors"])


def train(folder: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["train", str(folder / "dataset.toml"), "--out", str(folder / "out"), *options])


def written(folder: Path) -> list[str]:
    out = folder / "out"
    return sorted(p.name for p in out.iterdir()) if out.exists() else []


def assert_restored(folder: Path, checkpoint: str, fits: list[float]) -> None:
    """`greybox compare` finds of a checkpoint what `train` reported."""
    compared = CliRunner().invoke(
        app, ["compare", str(folder / "dataset.toml"), checkpoint, "--json", "--out", str(folder / "cmp")]
    )
    assert compared.exit_code == 0, compared.stderr
    _, restored = json.loads(compared.stdout)["models"]
    for row, fit in zip(restored["fit"], fits, strict=True):
        assert row["fit"] == pytest.approx(fit, abs=1e-6)


def test_json_and_checkpoint(motor_folder: Make) -> None:
    """A dead zone that the model does not know, learned as a change of the input."""
    folder = motor_folder(dead_zone=0.4)
    result = train(folder, *QUICK, "--json", "--no-explain")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert written(folder) == FILES and "explanation" not in found
    assert "training.safetensors" in result.stderr.split("Written to ")[1]
    assert found == json.loads((folder / "out" / "train.json").read_text())
    assert found["schema"] == "greybox-train/1"
    assert found["network"] == {
        "port": "actuator",
        "mechanism": "residual_net",
        "inputs": ["input"],
        "units": 4,
        "seed": 0,
    }
    assert found["parameters"]["J"]["unit"] == "kg m^2"
    assert found["parameters"]["actuator.residual_net.out_0"]["unit"] == "V"
    assert found["statistics"]["epochs"] == len(found["history"]) > 0
    assert found["statistics"]["held_out"][0]["penalty"] is None
    sweep = found["fit"][2]
    assert (sweep["experiment"], sweep["role"]) == ("Sweep", "validation")
    assert sweep["augmented"]["fit"] > sweep["refit"]["fit"] + 1.0

    checkpoint = str(folder / "out" / "model")
    assert load_checkpoint(Path(checkpoint)).effects[0]["mechanism"] == "residual_net"
    assert_restored(folder, checkpoint, [row["augmented"]["fit"] for row in found["fit"]])


def test_explained(motor_folder: Make) -> None:
    """What the network has learned of the dead zone is named, and the model with that law is kept beside the hybrid."""
    folder = motor_folder(dead_zone=0.4)
    result = train(folder, *QUICK, "--json", "--ensemble", "2")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert written(folder) == EXPLAINED
    said = found["explanation"]
    assert said["drop_network"] and said["sentence"].startswith("actuator.actuator_deadzone does what the network does")
    assert said["members"] == 2 and "differences of 2 seeds" in said["band"]
    (curve,) = said["curves"]
    assert (curve["signal"], curve["unit"], curve["force_unit"]) == ("input", "V", "V")
    assert len(curve["values"]) == len(curve["force"]) == len(curve["std"]) == 40
    assert all(std > 0 for std in curve["std"]) and curve["share"] > 0.9
    (half_gap,) = said["term"]["parameters"].values()
    assert half_gap["value"] == pytest.approx(0.4, rel=0.1) and half_gap["unit"] == "V"
    assert said["terms"][0]["lost"] < 0.02
    for row in found["fit"]:
        assert row["named"]["fit"] > row["augmented"]["fit"] - 0.5

    named = str(folder / "out" / "named")
    assert load_checkpoint(Path(named)).effects[0]["mechanism"] == "actuator_deadzone"
    assert_restored(folder, named, [row["named"]["fit"] for row in found["fit"]])


def test_summary(motor_folder: Make) -> None:
    folder = motor_folder(dead_zone=0.4)
    result = train(folder, *QUICK)
    assert result.exit_code == 0, result.stderr
    assert "actuator.actuator_deadzone does what the network does" in result.stdout
    assert "Share of the learned change of the input that each signal alone explains: voltage" in result.stdout
    assert "learned.png, named.safetensors, named.json" in result.stdout
    assert "With a network at actuator the mean squared error of the estimation experiments falls from" in result.stdout
    assert "residual_net at actuator: inputs voltage; units 4; seed 0" in result.stdout
    assert "physics alone" in result.stdout
    assert "epoch 1  loss" in result.stderr


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--net", "fiction"), "--net fiction: unknown"),
        (("--port", "rotary"), "--port rotary: model Motor has no such port"),
        (("--signals", "speed,load"), "--signals load: there is no such signal at rotor"),
        (("--signals", "angle"), "--signals angle: expected the speed among them"),
        (("--gradient", "adjoint"), "--gradient adjoint: unknown"),
        (("--resume",), "training.safetensors: no such file"),
        (("--units", "0"), ""),
        (("--epochs", "0"), ""),
    ],
)
def test_input_at_fault(options: tuple[str, ...], expected: str, motor_folder: Make) -> None:
    folder = motor_folder()
    result = train(folder, *options)
    assert result.exit_code == 2
    assert expected in result.stderr and "Traceback" not in result.stderr
    assert (result.stdout, written(folder)) == ("", [])


def test_a_wrong_signal_is_refused_before_anything_is_estimated(motor_folder: Make) -> None:
    folder = motor_folder()
    result = train(folder, "--net", "residual", "--port", "rotor", "--signals", "speed,sped")
    assert result.exit_code == 2 and "estimating" not in result.stderr
    assert '--signals sped: there is no such signal at rotor (did you mean "speed"?)' in result.stderr


def test_tensorboard_that_is_not_there(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch.utils.tensorboard", None)
    folder = motor_folder()
    result = train(folder, "--tensorboard")
    assert result.exit_code == 2
    assert "--tensorboard: the package tensorboard is not installed" in result.stderr
    assert written(folder) == []


def test_tensorboard(motor_folder: Make) -> None:
    pytest.importorskip("tensorboard", reason="the extra tensorboard is not installed")
    folder = motor_folder()
    assert train(folder, *QUICK, "--tensorboard", "--no-explain").exit_code == 0
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    events = EventAccumulator(str(folder / "out" / "tensorboard"))
    events.Reload()
    epochs = json.loads((folder / "out" / "train.json").read_text())["history"]
    logged = [e.value for e in events.Scalars("held_out")]
    assert logged == pytest.approx([e["held_out"] for e in epochs], rel=1e-6)


def test_all_results_or_none(motor_folder: Make) -> None:
    folder = motor_folder()
    (folder / "out" / "train.json").mkdir(parents=True)
    result = train(folder, *QUICK)
    assert result.exit_code == 2
    assert "train.json: cannot be written: it is a folder" in result.stderr
    assert written(folder) == ["train.json", "training.safetensors"]


def test_killed_and_resumed(motor_folder: Make) -> None:
    """SIGKILL at a random moment of the training; what goes on from the snapshot ends at the same validation fit."""
    folder = motor_folder(dead_zone=0.4)
    command = ["train", str(folder / "dataset.toml"), *QUICK[:-1], "25", "--no-explain", "--json"]

    def validation_fit(*options: str) -> Any:
        done = CliRunner().invoke(app, [*command, *options])
        assert done.exit_code == 0, done.stderr
        return json.loads(done.stdout)["fit"][2]["augmented"]["fit"]

    whole = validation_fit("--out", str(folder / "whole"))
    part, delay = folder / "part", random.uniform(0.0, 0.6)
    process = subprocess.Popen(
        [sys.executable, "-m", "greybox_torch", *command, "--out", str(part)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    while not (part / "training.safetensors").exists() and process.poll() is None:
        time.sleep(0.002)
    time.sleep(delay)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert validation_fit("--out", str(part), "--resume") == pytest.approx(whole, abs=1e-6), f"killed after {delay} s"


def test_a_wrong_network_is_refused_before_training_is_said_to_begin(motor_folder: Make) -> None:
    result = train(motor_folder(), "--net", "frictoin")
    assert result.exit_code == 2
    assert result.stderr.startswith('error: --net frictoin: unknown (did you mean "friction"?)')


@pytest.mark.parametrize(
    ("epochs", "options", "told"),
    [
        (False, (), "nothing is written"),  # seen: "interrupted" alone, while the physics was estimated
        (True, (), "the same command with --resume goes on from"),
        (False, ("--resume",), "the same command with --resume goes on from"),
    ],
)
def test_ctrl_c(
    epochs: bool, options: tuple[str, ...], told: str, motor_folder: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line, whether or not the folder has the snapshot of an earlier training."""

    def stopped(*_: Any, snapshot: Path, **__: Any) -> None:
        if epochs:
            snapshot.write_bytes(b"new")
        raise KeyboardInterrupt

    folder = motor_folder()
    (folder / "out").mkdir()
    (folder / "out" / "training.safetensors").write_bytes(b"of an earlier training")
    monkeypatch.setattr(train_command, "train", stopped)
    result = train(folder, *options)
    assert result.exit_code == 130
    assert result.stderr.splitlines()[-1].startswith(f"interrupted; {told}") and "stopped" not in result.stderr
