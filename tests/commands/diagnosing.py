"""The command `diagnose` on a folder with a card."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from typer.testing import CliRunner, Result

from greybox_torch.cli import app

Make = Callable[..., Path]
Edit = Callable[[Path, str, str], None]
FILES = ["hypotheses.json", "model.json", "model.safetensors", "report.html", "verdict.json"]


def diagnose(folder: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["diagnose", str(folder / "dataset.toml"), "--out", str(folder / "out"), *options])


def written(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / "out").iterdir()) if (folder / "out").exists() else []
