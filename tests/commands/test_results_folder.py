"""Where results cannot be written, every command says so before it does anything."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from greybox_torch.cli import app

COMMANDS = [
    *(
        [name, "nowhere.toml"]
        for name in ("inspect", "simulate", "fit", "compare", "residuals", "diagnose", "train", "fleet")
    ),
    ["design", "."],
    ["export", "nowhere", "--to", "c"],
]


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="no /proc, in which not even the administrator can write")
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_a_place_where_nothing_can_be_written(command: list[str]) -> None:
    """The card is not even there: the place for results is asked for first."""
    done = CliRunner().invoke(app, [*command, "--out", "/proc/x"])
    assert done.exit_code == 2, done.output
    assert done.stderr.startswith("error: --out /proc/x: nothing can be written in /proc (")
    assert done.stderr.endswith("); expected a folder for results\n")


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_a_file_in_the_way(command: list[str], tmp_path: Path) -> None:
    taken = tmp_path / "afile"
    taken.touch()
    done = CliRunner().invoke(app, [*command, "--out", str(taken)])
    assert done.exit_code == 2, done.output
    assert done.stderr == f"error: --out {taken}: {taken} is a file; expected a folder for results\n"


@pytest.mark.parametrize("folder", [".", "a/b"])
def test_trying_it_leaves_nothing_behind(tmp_path: Path, folder: str) -> None:
    done = CliRunner().invoke(app, ["inspect", str(tmp_path / "nowhere.toml"), "--out", str(tmp_path / folder)])
    assert done.exit_code == 2
    assert "nowhere.toml: no such file" in done.stderr
    assert list(tmp_path.iterdir()) == []
