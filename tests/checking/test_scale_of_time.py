"""A sample time far above the machine's times, a recording of decades, and hours that were taken for seconds are told with a unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import greybox_torch as gt
from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.scale_of_time import coarse, decades, in_larger_units
from greybox_torch.data import load_dataset


class Plate(gt.GreyBoxModel):
    """A heated plate with a time constant of 500 s."""

    states = (gt.State("T", "degC", initial="measured"),)
    inputs = (gt.Input("P", "W"),)
    outputs = (gt.Output("T", "degC"),)
    parameters = (gt.Parameter("C", 1000.0, unit="J/K"), gt.Parameter("h", 2.0, unit="W/K"))

    def derivative(self, x, u, p, port):
        return {"T": (u.P - p.h * x.T) / p.C}

    def output(self, x, u, p):
        return {"T": x.T}


def card(folder: Path, stamps: list[str], time: str = '"clk"') -> gt.DataSet:
    rows = [f"{stamp},{np.sin(k):.4f},{20 + np.cos(k):.4f}" for k, stamp in enumerate(stamps)]
    (folder / "run.csv").write_text("\n".join(["clk,P,T", *rows]))
    path = folder / "dataset.toml"
    channels = '[channels]\nP = { column = "P", unit = "W" }\nT = { column = "T", unit = "degC" }\n'
    path.write_text(f'time = {time}\n{channels}[[experiment]]\nname = "run"\nfile = "run.csv"\n')
    return load_dataset(path)


def test_milliseconds_that_were_read_as_seconds(tmp_path: Path) -> None:
    data = card(tmp_path, [str(20000 * k) for k in range(200)])
    (told,) = [one for one in data_warnings(data, Plate()) if "sample time" in one.found]
    assert "the sample time, 2e+04 s, is 40 times the slowest time constant, 500 s by the model's values" in told.found
    units = '{ column = "clk", unit = "ms" } or { column = "clk", unit = "us" }'
    assert told.write == f"time = {units}, if the stamps are so"
    mended = card(tmp_path, [str(20000 * k) for k in range(200)], '{ column = "clk", unit = "ms" }')
    assert not [*coarse(mended, 500.0)] and not [*decades(mended)]


def test_decades(tmp_path: Path) -> None:
    """Seen: 43 years of a robot's joint, in steps of 2000 s, were looked at without a word."""
    (told,) = decades(card(tmp_path, [str(2000000 * k) for k in range(1000)]))
    assert "lasts 47.5 years, with a sample time of 2e+06 s" in told.found
    assert 'unit = "ms" } or { column = "clk", unit = "us" }' in told.write
    assert not [*decades(card(tmp_path, [str(20 * k) for k in range(1000)]))]


def test_hours_that_were_read_as_seconds(tmp_path: Path) -> None:
    data = card(tmp_path, [str(k) for k in range(24)])
    (told,) = [one for one in data_warnings(data, Plate()) if "hardly determined" in one.found]
    assert told.write.endswith(
        'or time = { column = "clk", unit = "min" } or { column = "clk", unit = "h" }, if the stamps are so'
    )


def test_dates_have_no_other_unit(tmp_path: Path) -> None:
    data = card(tmp_path, [f"2026-01-05 00:00:{k:02d}" for k in range(24)])
    assert in_larger_units(data, 500.0) == ""
    years = card(tmp_path, [f"{1990 + k}-01-05 00:00:00" for k in range(24)])
    assert [one.write for one in decades(years)] == ["time stamps, or a sample time, in s"]


def test_data_in_memory() -> None:
    run = gt.Recording.from_arrays("run", {"P": np.ones(20), "T": np.arange(20.0)}, sample_time=10000.0)
    (told,) = coarse(gt.DataSet([run]), 500.0)
    assert told.write == "a sample time in s, or other start values of the parameters"
    assert not [*coarse(gt.DataSet([run]), 1000.0)] and not [*coarse(gt.DataSet([run]), None)]
