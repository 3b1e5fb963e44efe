"""Checkpoints with effects, as `diagnose` writes them, on the way back into `compare`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.cli import app
from greybox_torch.diagnose.restore import attachment_json
from greybox_torch.mechanisms.actuator import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Range, Surroundings

Make = Callable[..., Path]

AROUND = Surroundings({"input": Range(-3.0, 3.0, 1.7)}, {"input": "V"}, "V", 0.01)
DEADZONE = attachment_json(Attachment("actuator", ActuatorDeadzone()), AROUND)


def saved(folder: Path, effects: list[dict[str, Any]], **more: float) -> str:
    values = {"J": 0.02, "k": 0.1, "b": 0.05, **more}
    model = f"{folder.resolve()}/my_motor.py:Motor"
    save_checkpoint(folder / "model", Checkpoint(model, "Motor", values, {}, effects, free_starts=True))
    return str(folder / "model")


def compare(folder: Path, checkpoint: str) -> Result:
    arguments = ["compare", str(folder / "dataset.toml"), checkpoint, "--json", "--out", str(folder / "out")]
    return CliRunner().invoke(app, arguments)


def test_the_effect_is_simulated(motor_folder: Make) -> None:
    """With the true dead zone attached nothing but noise is left."""
    folder = motor_folder(dead_zone=0.4)
    result = compare(folder, saved(folder, [DEADZONE], **{"actuator.actuator_deadzone.half_width": 0.4}))
    assert result.exit_code == 0, result.stderr
    start, restored = json.loads(result.stdout)["models"]
    for before, after in zip(start["fit"], restored["fit"], strict=True):
        assert after["rmse"] == pytest.approx(0.02, rel=0.15)
        assert before["rmse"] > 5 * after["rmse"]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"port": "rotary"}, ["no port 'rotary'", "rotor, actuator, sensor"]),
        ({"mechanism": "stiction"}, ["mechanism 'stiction' is not in the library", "coulomb_friction"]),
        ({"options": {"order": 2}}, ['"effects" are damaged', "ActuatorDeadzone"]),
        ({"surroundings": {}}, ['"effects" are damaged', "ranges"]),
    ],
)
def test_effects_that_cannot_be_attached(motor_folder: Make, change: dict[str, Any], expected: list[str]) -> None:
    folder = motor_folder()
    path = saved(folder, [{**DEADZONE, **change}], **{"actuator.actuator_deadzone.half_width": 0.4})
    result = compare(folder, path)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"error: checkpoint {path}: ")
    for text in expected:
        assert text in result.stderr
    assert result.stdout == ""


def test_values_of_another_effect(motor_folder: Make) -> None:
    folder = motor_folder()
    result = compare(folder, saved(folder, [DEADZONE], **{"rotor.coulomb_friction.F_c": 0.4}))
    assert result.exit_code == 2
    assert "it lacks actuator.actuator_deadzone.half_width; it has rotor.coulomb_friction.F_c" in result.stderr
