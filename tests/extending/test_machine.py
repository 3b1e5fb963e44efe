"""A machine from a user's own file: its class is simulated, and a card in any folder names it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app

TANK = '''
import greybox_torch as gt


class Tank(gt.GreyBoxModel):
    """A tank that is filled by a pump and empties through a pipe: A dh/dt = q − h / R."""

    states = [gt.State("level", "m", initial="measured")]
    inputs = [gt.Input("inflow", "m^3/s")]
    outputs = [gt.Output("level", "m")]
    parameters = [
        gt.Parameter("A", 0.5, unit="m^2", lower=1e-3),
        gt.Parameter("R", 100.0, unit="s/m^2", lower=1e-3),
    ]
    ports = [gt.Balance("tank", level="level")]

    def derivative(self, x, u, p, port):
        return {"level": (u.inflow - x.level / p.R) / p.A + port.tank}

    def output(self, x, u, p):
        return {"level": x.level}
'''

CARD = """
sample_time = 1.0
[channels]
inflow = { column = "q", unit = "m^3/s" }
level = { column = "h", unit = "m" }
[[experiment]]
name = "Filling"
file = "filling.csv"
role = "estimation"
[[experiment]]
name = "Steps"
file = "steps.csv"
role = "validation"
[model]
name = "tank.py:Tank"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Recordings of a tank of 0.3 m² that empties through 150 s/m²."""
    (tmp_path / "tank.py").write_text(TANK)
    (tmp_path / "dataset.toml").write_text(CARD)
    rng = np.random.default_rng(0)
    for name, inflow in (("filling", np.full(400, 0.004)), ("steps", np.repeat(rng.uniform(0, 0.008, 8), 50))):
        level = [0.1]
        for q in inflow[:-1]:
            settled = 150.0 * q
            level.append(settled + (level[-1] - settled) * np.exp(-1.0 / (150.0 * 0.3)))
        rows = np.column_stack([inflow, np.array(level) + rng.normal(0, 1e-3, len(level))])
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header="q,h", comments="")
    return tmp_path


def test_it_is_estimated_from_its_recordings(folder: Path) -> None:
    done = CliRunner().invoke(app, ["fit", str(folder / "dataset.toml"), "--json", "--out", str(folder / "out")])
    assert done.exit_code == 0, done.stderr
    found = {name: p["value"] for name, p in json.loads(done.stdout)["parameters"].items()}
    assert found["A"] == pytest.approx(0.3, rel=0.02)
    assert found["R"] == pytest.approx(150.0, rel=0.02)


def test_its_class_is_loaded_by_file_and_name(folder: Path) -> None:
    model = gt.load_model(f"{folder / 'tank.py'}:Tank")
    assert model.title == "Tank" and model.values() == {"A": 0.5, "R": 100.0}
    with pytest.raises(gt.UserError, match="class 'Vessel' is not defined; it defines Tank"):
        gt.load_model(f"{folder / 'tank.py'}:Vessel")
