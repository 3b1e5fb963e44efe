"""`greybox train` on a model that has balances and no body."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import greybox_torch as gt
from greybox_torch.cli import app
from greybox_torch.errors import ArgumentError

KILN = """from greybox_torch import Balance, GreyBoxModel, Input, Output, Parameter, State


class Kiln(GreyBoxModel):
    states = [State("chamber", "degC", initial="measured")]
    inputs = [Input("heat", "kW")]
    outputs = [Output("chamber", "degC")]
    parameters = [Parameter("C", 1.2, unit="kJ/K", lower=0.1), Parameter("G", 0.5, unit="kW/K", lower=0.0)]
    ports = [Balance("chamber", level="chamber")]

    def derivative(self, x, u, p, port):
        return {"chamber": (u.heat - p.G * x.chamber + port.chamber) / p.C}

    def output(self, x, u, p):
        return {"chamber": x.chamber}
"""
KILN_CARD = """name = "kiln"
sample_time = 0.1
hold = "zoh"

[channels]
heat = { column = "heat", unit = "kW" }
chamber = { column = "chamber", unit = "degC" }

[[experiment]]
name = "run"
file = "run.csv"
role = "estimation"

[model]
name = "kiln.py:Kiln"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A card, a model file and a recording of a kiln that loses more heat than the model knows."""
    (tmp_path / "kiln.py").write_text(KILN)
    (tmp_path / "dataset.toml").write_text(KILN_CARD)
    rng, level, rows = np.random.default_rng(0), 0.0, []
    for heat in np.repeat(rng.uniform(0.0, 2.0, 40), 10):
        rows.append((heat, level + rng.normal(0.0, 0.01)))
        level += 0.1 * (heat - 0.4 * level - 0.05 * level**2)
    np.savetxt(tmp_path / "run.csv", rows, delimiter=",", header="heat,chamber", comments="")
    return tmp_path


def train(folder: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["train", str(folder / "dataset.toml"), "--out", str(folder / "out"), *options])


def test_the_net_is_one_that_fits_the_first_port(folder: Path) -> None:
    """Seen: "--net friction: model Kiln has no body", though no --net was given; and "the learned force" for a flow of heat."""
    result = train(folder, "--epochs", "2", "--units", "2")
    assert result.exit_code == 0, result.stderr
    made = json.loads((folder / "out" / "train.json").read_text())["network"]
    assert (made["port"], made["mechanism"], made["inputs"]) == ("chamber", "residual_net", ["level"])
    assert "Share of the learned flow that each signal alone explains: chamber" in result.stdout
    assert "refit: the physics alone, estimated on whole records" in result.stdout
    refused = train(folder, "--net", "friction")
    assert refused.exit_code == 2
    assert '--net friction: model Kiln has no body; expected the net "residual"' in refused.stderr


def test_from_python(folder: Path) -> None:
    data = gt.load_dataset(folder / "dataset.toml")
    model, settings = gt.load_model(str(data.model)), gt.TrainingSettings(epochs=1)
    found = gt.train(model, data, settings=settings, explain=False)
    assert found.to_dict()["network"]["mechanism"] == "residual_net" and "flow" in found.trained.hybrid.adds
    with pytest.raises(
        ArgumentError, match="network: found 'odd', a residual network has no such option; expected some of units, seed"
    ):
        gt.train(model, data, network={"odd": False})
