"""Recordings and cards that are sound, and hardly enough: each command ends with a result, or says what is too little."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from greybox_torch.cli import app
from tests.faults.conftest import CARD, CSV

COMMANDS = (
    ["simulate"],
    ["fit"],
    ["residuals"],
    ["diagnose", "--time-limit", "2"],
    ["train", "--epochs", "1"],
)


def run(folder: Path, command: list[str]) -> Result:
    return CliRunner().invoke(
        app, [command[0], str(folder / "dataset.toml"), *command[1:], "--out", str(folder / "out")]
    )


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_ten_samples_of_which_a_quarter_is_held_out(spoilt: Path, command: list[str]) -> None:
    head, one, _ = CARD.split("[[experiment]]")
    card = f"{head}[[experiment]]{one}".replace('role = "estimation"', "") + '[model]\nname = "my_motor.py:Motor"\n'
    (spoilt / "dataset.toml").write_text(card)
    (spoilt / "a.csv").write_text("\n".join(CSV.splitlines()[:11]) + "\n")
    done = run(spoilt, command)
    if command[0] == "train":
        assert (done.exit_code, "with at least 80 samples" in done.stderr) == (2, True)
    else:
        assert done.exit_code == 0, (done.exception, done.stderr)


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_nothing_to_estimate(spoilt: Path, command: list[str]) -> None:
    fixed = CARD.replace("J = { value = 0.02 }", "J = { fixed = true }\nk = { fixed = true }\nb = { fixed = true }")
    fixed = fixed.replace("speed = { value = 0.0 }", "speed = { value = 0.0, fixed = true }")
    (spoilt / "dataset.toml").write_text(fixed)
    done = run(spoilt, command)
    assert done.exit_code in (0, 2), (done.exception, done.stderr)
    assert "Traceback" not in done.output
