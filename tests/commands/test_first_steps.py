"""The way of a new user: a model file, a card from an instrument's files, a check, a diagnosis, and the model taken home."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from greybox_torch.cli import app


def write_log(file: Path, seed: int) -> None:
    """A motor with dry friction, as an instrument exports it: semicolons, decimal commas, a line of units, milliseconds and rpm."""
    draw = np.random.default_rng(seed)
    speed, lines = 0.0, []
    for k, volts in enumerate(np.repeat(draw.uniform(-5, 5, 30), 20)):
        shown = speed * 60 / (2 * np.pi) + 0.05 * draw.normal()
        lines.append(f"{10 * k};{volts:.4f};{shown:.4f}".replace(".", ","))
        for _ in range(10):
            speed += 1e-3 * (0.1 * volts - 0.04 * speed - 0.08 * np.tanh(speed / 0.05)) / 0.015
    file.write_text("Bench 7; operator: K\nt_ms;MotorVoltage;n_motor\nms;V;rpm\n" + "\n".join(lines) + "\n")


def test_from_nothing_to_the_exported_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_log(tmp_path / "monday.csv", 1)
    write_log(tmp_path / "tuesday.csv", 2)
    for arguments in (
        ["new", "my_drive"],
        ["card", "monday.csv", "tuesday.csv", "--model", "my_drive.py:MyDrive"],
        ["check", "dataset.toml"],
        ["diagnose", "dataset.toml", "--out", "found"],
        ["export", "found", "--to", "c", "--dataset", "dataset.toml"],
    ):
        done = CliRunner().invoke(app, arguments)
        assert done.exit_code == 0, (arguments, done.output)
    (effect,) = json.loads((tmp_path / "found" / "verdict.json").read_text())["effects"]
    assert (effect["port"], effect["mechanism"]) == ("rotor", "coulomb_friction")
    assert effect["parameters"]["F_c"]["value"] == pytest.approx(0.08, rel=0.05)
    assert "rotor.coulomb_friction.F_c [N m]" in (tmp_path / "found" / "c" / "MyDrive.h").read_text()
