"""A sound folder to spoil, and what every answer to a fault has to be: one message, its exit code, and nothing written."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.cli import app

CARD = """\
name = "Bench"
sample_time = 0.01
hold = "zoh"

[channels]
voltage = { column = "u", unit = "V" }
speed = { column = "y", unit = "rad/s" }

[[experiment]]
name = "A"
file = "a.csv"
role = "estimation"

[[experiment]]
name = "B"
file = "a.csv"
role = "validation"
rows = [10, 60]

[model]
name = "my_motor.py:Motor"

[model.parameters]
J = { value = 0.02 }

[model.initial]
speed = { value = 0.0 }
"""
U, Y = np.sin(np.arange(80) / 5), np.cos(np.arange(80) / 5)
CSV = "u,y\n" + "".join(f"{u:.6g},{y:.6g}\n" for u, y in zip(U, Y, strict=True))
UNITS = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}

Answer = Callable[..., str]


@pytest.fixture
def spoilt() -> Iterator[Path]:
    """The sound folder, in memory where there is one: a card, a recording, a model, a checkpoint."""
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None) as name:
        folder = Path(name)
        (folder / "dataset.toml").write_text(CARD)
        (folder / "a.csv").write_text(CSV)
        (folder / "my_motor.py").write_text((Path(__file__).parents[1] / "machines" / "motor.py").read_text())
        values = {"J": 0.02, "k": 0.1, "b": 0.05}
        save_checkpoint(folder / "model", Checkpoint(f"{folder}/my_motor.py:Motor", "Motor", values, UNITS))
        yield folder


@pytest.fixture
def answer(spoilt: Path, monkeypatch: pytest.MonkeyPatch) -> Answer:
    """Runs a command in the folder and checks how it ends; returns its message."""
    monkeypatch.chdir(spoilt)

    def run(*arguments: str, code: int = 2, message: str = "") -> str:
        done = CliRunner().invoke(app, [*arguments, "--out", "out"] if "--out" not in arguments else list(arguments))
        assert done.exit_code == code, (done.exit_code, done.exception, done.output)
        assert done.exception is None or isinstance(done.exception, SystemExit)
        assert "Traceback" not in done.output
        if code:
            assert done.stdout == ""
            starts = [
                line
                for line in done.stderr.splitlines()
                if line.startswith(("error: ", "the numbers failed: ", "Usage: "))
            ]
            assert len(starts) == 1, done.stderr
            assert message in " ".join(done.stderr.split()), done.stderr
            assert not (spoilt / "out").exists() or not any((spoilt / "out").iterdir())
        return done.stderr

    return run
