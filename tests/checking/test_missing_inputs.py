"""Stretches in which an input is missing are told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from greybox_torch.api.check import check
from greybox_torch.checking.missing_inputs import LONGEST, missing_inputs
from greybox_torch.cli import app
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.systems import model_class

COUNT = 200
"""Samples, of which the last quarter is held out."""


@pytest.fixture
def card(tmp_path: Path, machines: Path):
    """The card of a motor whose voltage, or speed, lacks stretches of samples."""

    def make(**gone: list[slice]) -> Path:
        rng = np.random.default_rng(0)
        signals = {"voltage": np.repeat(rng.normal(size=COUNT // 10), 10), "speed": rng.normal(size=COUNT)}
        for name, stretches in gone.items():
            for stretch in stretches:
                signals[name][stretch] = np.nan
        rows = zip(*signals.values(), strict=True)
        lines = ["voltage,speed", *(",".join("" if np.isnan(v) else f"{v:.4f}" for v in row) for row in rows)]
        (tmp_path / "run.csv").write_text("\n".join(lines))
        (tmp_path / "card.toml").write_text(
            f'''name = "Motor"
sample_time = 0.01
[channels]
voltage = {{ column = "voltage", unit = "V" }}
speed = {{ column = "speed", unit = "rad/s" }}
[[experiment]]
name = "run"
file = "run.csv"
role = "estimation"
[model]
name = "{machines / "motor.py"}:Motor"
'''
        )
        return tmp_path / "card.toml"

    return make


def gaps(data: DataSet, machines: Path) -> list:
    return list(missing_inputs(data, model_class(f"{machines / 'motor.py'}:Motor")()))


def test_the_longest_stretch_of_an_input_is_told(card, machines: Path) -> None:
    (gap,) = gaps(load_dataset(card(voltage=[slice(20, 23), slice(60, 95)], speed=[slice(0, 50)])), machines)
    assert (gap.experiment, gap.channel, gap.first, gap.count, gap.missing) == ("run", "voltage", 60, 35, 38)
    assert gap.seconds == pytest.approx(0.35)
    assert "38 of 150 samples of this input are missing, 35 of them (0.35 s) from sample 60 on" in gap.found


def test_a_few_lost_samples_and_those_of_outputs_are_nothing(card, machines: Path) -> None:
    few = [slice(k, k + LONGEST) for k in (0, 40, 195)]
    assert gaps(load_dataset(card(voltage=few, speed=[slice(60, 120)])), machines) == []


def test_check_and_fit_warn(card) -> None:
    path = card(voltage=[slice(60, 95)])
    data = load_dataset(path)
    assert data.model is not None
    (finding,) = [f for f in check(data.model, data).findings if "samples of this input" in f.found]
    assert finding.level == "warning" and finding.file == path and "rows = [first, last]" in finding.write
    told = CliRunner().invoke(app, ["simulate", str(path), "--out", str(path.parent / "out")])
    assert told.exit_code == 0, told.output
    assert (
        "warning: " in told.stderr and 'channel "voltage": 35 of 150 samples of this input are missing' in told.stderr
    )
