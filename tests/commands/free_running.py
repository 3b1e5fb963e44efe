"""The commands that simulate, on a folder with a card."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from typer.testing import CliRunner, Result

from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.cli import app

Make = Callable[..., Path]
Edit = Callable[[Path, str, str], None]
PNG = b"\x89PNG"


def greybox(command: str, folder: Path, *options: str) -> Result:
    arguments = [command, str(folder / "dataset.toml"), *options]
    return CliRunner().invoke(app, arguments if "--out" in options else [*arguments, "--out", str(folder / "out")])


def of(command: str, folder: Path, *options: str) -> dict[str, Any]:
    result = greybox(command, folder, "--json", *options)
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def saved(folder: Path, stem: str, inertia: float = 0.02, damping: float = 0.05, **changes: Any) -> str:
    units = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}
    options = {
        "model": f"{folder.resolve()}/my_motor.py:Motor",
        "title": "Motor",
        "values": {"J": inertia, "k": 0.1, "b": damping},
        **changes,
    }
    options["units"] = {name: units.get(name, "kg m^2") for name in options["values"]}
    save_checkpoint(folder / stem, Checkpoint(**options))
    return str(folder / stem)
