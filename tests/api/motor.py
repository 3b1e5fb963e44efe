"""The documentation's motor, what the command line says of it, and what every result can do."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app
from tests.pictures import not_painted

Make = Callable[..., Path]
UNITS = {"voltage": "V", "speed": "rad/s"}
ASIDE = {"seconds", "stages", "checkpoint", "tables", "figures", "figure", "sample_time"}


class Motor(gt.GreyBoxModel):
    """The documentation's motor with the start values of the card that the command line is given."""

    states = [gt.State("speed", "rad/s")]
    inputs = [gt.Input("voltage", "V")]
    outputs = [gt.Output("speed", "rad/s")]
    parameters = [
        gt.Parameter("J", 0.03, unit="kg m^2", lower=0.0),
        gt.Parameter("k", 0.10, unit="N m/V", lower=0.0, fixed=True),
        gt.Parameter("b", 0.08, unit="N m s/rad", lower=0.0, upper=1.0),
    ]
    ports = [gt.Body("rotor", speed="speed")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (p.k * u.voltage - p.b * x.speed + port.rotor) / p.J}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


def told(folder: Path, command: str, *options: str) -> dict[str, Any]:
    """What the command prints with --json for the same data on files."""
    arguments = [command, str(folder / "dataset.toml"), *options, "--json", "--out", str(folder / "out")]
    with not_painted():
        result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def numbers(told: Any) -> Any:
    """Without what depends on the clock, and on where models and files are."""
    if isinstance(told, dict):
        names = [name for name in told if name not in ASIDE and not (name == "model" and isinstance(told[name], str))]
        return {name: numbers(told[name]) for name in names}
    return [numbers(value) for value in told] if isinstance(told, list) else told


def check_shown(result: Any, folder: Path, files: set[str], folders: dict[str, set[str]] | None = None) -> None:
    """Prints, shows itself, draws and saves; JSON is strict, and what it names is there."""
    below = folders or {}
    assert "Motor" in str(result) and len(repr(result)) < 300
    html = result._repr_html_()
    assert "<table>" in html and "data:image/png;base64," in html and "http" not in html
    assert isinstance(result.plot(), Figure)
    assert {path.name for path in result.save(folder)} == files.union(*below.values())
    assert {path.name for path in folder.iterdir()} == files | set(below)
    assert all({path.name for path in (folder / name).iterdir()} == inside for name, inside in below.items())
    text = result.to_json(folder)
    assert json.loads(text) == result.to_dict(folder) and text.endswith("}\n")
