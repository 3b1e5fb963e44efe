"""The command `fit` on a folder with a card."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from typer.testing import CliRunner, Result

from greybox_torch.cli import app

Make = Callable[..., Path]
Edit = Callable[[Path, str, str], None]


def fit(folder: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["fit", str(folder / "dataset.toml"), "--out", str(folder / "out"), *options])
