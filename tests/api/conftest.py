from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas
import pytest

import greybox_torch as gt
from tests.api.motor import UNITS, Make


@pytest.fixture
def folder(motor_folder: Make) -> Path:
    """The motor with a dead zone of 0.4 V that the model does not know."""
    return motor_folder(dead_zone=0.4)


@pytest.fixture
def data(folder: Path) -> gt.DataSet:
    """The same recordings from memory: one of a table, the others of arrays."""
    columns = {
        name: np.genfromtxt(folder / f"{name}.csv", delimiter=",", names=True) for name in ("steps", "more", "sweep")
    }
    arrays = {name: {"voltage": table["v"], "speed": table["w"]} for name, table in columns.items()}
    frame = pandas.DataFrame({"t": np.arange(600) * 0.01, **arrays["steps"]})
    steps = gt.Recording.from_dataframe("Steps", frame, time="t", role="estimation", units=UNITS)
    more = gt.Recording.from_arrays("More steps", arrays["more"], sample_time=0.01, role="estimation")
    sweep = gt.Recording.from_arrays("Sweep", arrays["sweep"], sample_time=0.01, role="validation", units=UNITS)
    return gt.DataSet([steps, more, sweep], hold="zoh", name="Motor on the bench")
