"""What a drafted card says of uneven clocks and gaps, and of names that end in a unit of one letter."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.drafting.matching import letter_unit

MODEL = """
from greybox_torch import GreyBoxModel, Input, Output, Parameter, State


class Stage(GreyBoxModel):
    states = [State("v", "m/s")]
    inputs, outputs = [Input("current", "A")], [Output("acc", "m/s^2")]
    parameters = [Parameter("k", 1.0, unit="m/(A s^2)")]

    def derivative(self, x, u, p, port):
        return {"v": p.k * u.current}

    def output(self, x, u, p):
        return {"acc": p.k * u.current}
"""


def drafted(folder: Path, time: np.ndarray, names: str = "t,u,y") -> str:
    rows = np.column_stack([time, np.cos(time), np.sin(time)])
    np.savetxt(folder / "run.csv", rows, "%.9g", ",", header=names, comments="")
    return gt.card([folder / "run.csv"]).text


def test_the_step_to_resample_by_is_that_of_the_file(tmp_path: Path) -> None:
    """Seen: 0.001 s for a logger of 2 s."""
    jittered = 2.0 * np.arange(60) + 0.1 * np.sin(np.arange(60.0) ** 2)
    assert "# resample = 2    #" in drafted(tmp_path, jittered)
    assert "# resample = 0.002    #" in drafted(tmp_path, jittered, "time_ms,u,y")


def test_a_gap_is_told_with_the_rows_around_it(tmp_path: Path) -> None:
    """Seen: nothing was said of a gap but "the time stamps are uneven"."""
    time = 2.0 * np.arange(60)
    time[30:] += 190.0
    text = drafted(tmp_path, time)
    assert "no sample for 192 s, from 58 to 250 s after the start" in text
    assert "rows = [0, 30] and rows = [30, 60]" in text and "resample" not in text
    assert "no sample" not in drafted(tmp_path, 2.0 * np.arange(60))


def test_units_of_one_letter(tmp_path: Path) -> None:
    """Seen: "no column fits" for a current beside i_q_A and an acceleration beside acc_payload_g."""
    rows = np.column_stack([np.arange(60.0), np.ones(60), np.ones(60), np.ones(60)])
    np.savetxt(tmp_path / "run.csv", rows, "%.9g", ",", header="t_s,counts,i_q_A,acc_payload_g", comments="")
    (tmp_path / "stage.py").write_text(MODEL)
    text = gt.card([tmp_path / "run.csv"], f"{tmp_path / 'stage.py'}:Stage").text
    assert 'current = { column = "i_q_A", unit = "A" }' in text
    assert 'acc = { column = "acc_payload_g", unit = "m/s^2", file_unit = "g0" }' in text


@pytest.mark.parametrize(
    ("column", "wanted", "unit"),
    [
        ("x_m", "mm", "m"),
        ("x_m", "rad", ""),
        ("m_g", "kg", ""),
        ("a_g", "m/s^2", "g0"),
        ("A", "A", ""),
        ("i_A", "", ""),
        ("Strom/A", "mA", "A"),
        ("i A", "mA", "A"),
    ],
)
def test_a_letter_is_a_unit_where_one_of_its_quantity_is_wanted(column: str, wanted: str, unit: str) -> None:
    assert letter_unit(column, wanted) == unit


@pytest.mark.parametrize("length", ["Ventilhub/mm", "Ventilhub / mm", "LI101 mm", "Hub in mm"])
def test_units_below_a_quantity_behind_in_and_behind_a_space(tmp_path: Path, length: str) -> None:
    """Seen: "no column fits; left over: Ventilhub/mm, Strom in A" of the only length and the only current, and of "LI101 mm"."""
    rows = np.column_stack([np.arange(60.0), np.ones(60), np.ones(60), np.ones(60)])
    header = f"t_s,{length},Strom in A,p"
    np.savetxt(tmp_path / "run.csv", rows, "%.9g", ",", header=header, comments="")
    (tmp_path / "stage.py").write_text(MODEL.replace('Output("acc", "m/s^2")', 'Output("acc", "mm")'))
    text = gt.card([tmp_path / "run.csv"], f"{tmp_path / 'stage.py'}:Stage").text
    assert f'acc = {{ column = "{length}", unit = "mm" }}' in text
    assert 'current = { column = "Strom in A", unit = "A" }' in text
