"""Commands that pages show can be typed as they stand, and every command is shown."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from greybox_torch.cli import app
from tests.documentation.pages import PAGES, ROOT, blocks, commands, pages_with

Make = Callable[..., Path]
GROUP: Any = typer.main.get_command(app)


def shown(page: str) -> list[str]:
    return [command for _, text in blocks(page, "sh") for command in commands(text)]


def run(command: str) -> None:
    done = CliRunner().invoke(app, shlex.split(command)[1:])
    assert done.exit_code == 0, (command, done.output)


@pytest.mark.parametrize("page", pages_with("sh"))
def test_options_and_arguments_are_understood(page: str) -> None:
    for command in shown(page):
        _, name, *given = shlex.split(command)
        GROUP.commands[name].make_context(name, given)  # raises where something is not understood


def test_every_command_is_shown_by_a_page() -> None:
    named = {shlex.split(command)[1] for page in PAGES for command in shown(page)}
    assert named == set(GROUP.commands)


@pytest.mark.parametrize("page", ["docs/howto/estimate.md", "docs/howto/diagnose.md", "docs/howto/train.md"])
def test_pages_say_with_what_ctrl_c_ends(page: str) -> None:
    """Seen: the reference alone had the exit code 130."""
    text = (ROOT / page).read_text()
    assert "Ctrl-C" in text and re.search(r"exit code\b.*\b130\b", text)


def test_the_tutorial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything that it shows, in its order: from an instrument's logs to the exported model."""
    monkeypatch.chdir(tmp_path)
    for language, text in blocks("docs/tutorial/first_diagnosis.md", "python", "sh"):
        if language == "python":
            exec(compile(text, "tutorial", "exec"), {})
        for command in commands(text):
            run(command)
    (effect,) = json.loads((tmp_path / "found" / "verdict.json").read_text())["effects"]
    assert (effect["port"], effect["mechanism"]) == ("rotor", "coulomb_friction")
    assert effect["parameters"]["F_c"]["value"] == pytest.approx(0.08, rel=0.05)
    for page in (
        "docs/tutorial/first_diagnosis.md",
        "docs/explanation/verdict.md",
    ):  # what they show is what is printed
        assert f"at rotor (probability {effect['probability']:.2f})" in (ROOT / page).read_text()
    lines = len((tmp_path / "my_drive.py").read_text().splitlines())
    assert f"it is {lines} lines with comments" in (ROOT / "docs/tutorial/first_diagnosis.md").read_text()
    assert "rotor.coulomb_friction.F_c [N m]" in (tmp_path / "found" / "c" / "MyDrive.h").read_text()
    fitted = json.loads((tmp_path / "fitted" / "fit.json").read_text())
    assert fitted["parameters"]["b"]["value"] == pytest.approx(0.064, abs=1e-3)  # as the page says


def test_the_motor_of_the_readme(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its model, with the commands of the README and of the pages on fitting and training."""
    folder = motor_folder()
    (folder / "my_motor.py").write_text(blocks("README.md", "python")[0][1])
    (folder / "dataset.toml").rename(folder / "own.toml")
    monkeypatch.chdir(folder)
    run("greybox card steps.csv sweep.csv --model my_motor.py:Motor --sample-time 0.01")
    (folder / "dataset.toml").write_text((folder / "own.toml").read_text())
    for page in ("README.md", "docs/howto/estimate.md", "docs/howto/train.md"):
        for command in shown(page):
            if command.split()[1] in ("diagnose", "simulate", "fit", "compare", "residuals", "train"):
                run(command)
