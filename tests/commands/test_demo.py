"""The demo, whole: the concealed effect is found, and the model that comes out simulates as the verdict says."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from greybox_torch.cli import app
from greybox_torch.commands.options import Options
from greybox_torch.demo import DATASET


def test_demo(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["demo", "--out", str(tmp_path / "demo"), "--json"])
    assert result.exit_code == 0, result.stderr
    verdict = json.loads(result.stdout)
    assert verdict["mismatch"]
    (effect,) = verdict["effects"]
    assert (effect["port"], effect["mechanism"], effect["signals"]) == ("gear_spring", "backlash", ["gear_twist"])
    truth = json.loads(DATASET.with_name("key.json").read_text())["switches"]["backlash.half_gap"]
    assert effect["parameters"]["half_gap"]["value"] == pytest.approx(truth, rel=0.01)
    assert effect["probability"] > 0.5
    assert effect["explained"] > 0.95
    for row in verdict["fit"]:
        assert row["augmented"]["rmse"] < 0.055 < 0.4 < row["refit"]["rmse"]
    page = (tmp_path / "demo" / "report.html").read_text()
    assert verdict["sentence"] in page
    assert len(page) < 3_000_000

    arguments = ["compare", str(DATASET), str(tmp_path / "demo" / "model"), "--out", str(tmp_path / "out"), "--json"]
    compared = CliRunner().invoke(app, arguments)
    assert compared.exit_code == 0, compared.stderr
    again = json.loads(compared.stdout)["models"][1]["fit"]
    for row, other in zip(verdict["fit"], again, strict=True):
        assert other["rmse"] == pytest.approx(row["augmented"]["rmse"], rel=0.01)


def test_default_folder_is_results_demo() -> None:
    assert Options().folder(DATASET) == Path("results/demo")
