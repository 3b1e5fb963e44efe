"""The card of a designed recording says of columns, units and time what the card of the old ones says."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.design_files import CARD, RECORDED, card_text
from greybox_torch.data import DataSet, Recording, load_dataset
from greybox_torch.data.card import read_card

OLD = """\
{clock}
hold = "foh"

[channels]
voltage = {{ column = 2, unit = "V" }}
speed = {{ column = "n_rpm", unit = "rad/s", file_unit = "rpm" }}
angle = {{ expr = "0.5 * (q1 + q2)", unit = "rad", scale = -1.0 }}

[[experiment]]
name = "Steps"
file = "steps.csv"

[model]
name = "models/motor.py:Motor"
"""
CLOCKS = {
    'time = { column = "t_ms", unit = "ms" }\ndecimate = 2': 0.01,
    'time = "t_s"\nresample = 0.005': 0.005,
    "sample_time = 0.005": 0.005,
}


def recorded(path: Path) -> None:
    stamps: np.ndarray = 0.005 * np.arange(60)
    rows = np.column_stack([1e3 * stamps, np.sin(stamps), np.cos(stamps), stamps, stamps, stamps])
    np.savetxt(path, rows, delimiter=",", header="t_ms,u,n_rpm,q1,q2,t_s", comments="", fmt="%.12g")


@pytest.mark.parametrize("clock", CLOCKS)
def test_the_experiment_can_be_copied_to_the_old_card(tmp_path: Path, clock: str) -> None:
    old, folder = tmp_path / "dataset.toml", tmp_path / "results" / "design"
    folder.mkdir(parents=True)
    old.write_text(OLD.format(clock=clock))
    recorded(tmp_path / "steps.csv")
    recorded(folder / RECORDED)
    data = load_dataset(old)
    time = CLOCKS[clock] * np.arange(30)
    (folder / CARD).write_text(card_text(data, time, str(data.model), folder))
    new, own = read_card(folder / CARD), read_card(old)
    assert (new.channels, new.time, new.sample_time) == (own.channels, own.time, own.sample_time)
    assert (new.resample, new.decimate, new.hold) == (own.resample, own.decimate, "foh")
    assert new.model.name == "../../models/motor.py:Motor"
    assert "to the card ../../dataset.toml, and recorded.csv beside it" in (folder / CARD).read_text()
    for one, other in zip(data.recordings, load_dataset(folder / CARD).recordings, strict=True):
        np.testing.assert_array_equal(one.signals["speed"], other.signals["speed"])
        assert one.sample_time == other.sample_time


def test_of_recordings_in_memory(tmp_path: Path) -> None:
    samples = {"voltage": np.ones(40), "speed": np.zeros(40)}
    data = DataSet([Recording.from_arrays("sweep", samples, sample_time=0.005, units={"voltage": "V"})])
    time = 1.0 + 0.005 * np.arange(40)  # whose difference is 0.004999999999999893
    card = tomllib.loads(card_text(data, time, "robot_arm", tmp_path))
    assert card["sample_time"] == 0.005 and card["model"]["name"] == "robot_arm"
    assert card["channels"]["voltage"] == {"column": "voltage", "unit": "V"}
