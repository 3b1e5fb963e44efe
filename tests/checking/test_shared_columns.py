"""One column for two channels is told; a derivative of it, a factor, or another column in an experiment is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.data import load_dataset

RUN = '[[experiment]]\nname = "run"\nfile = "run.csv"\n'
JUDGED = '[[experiment]]\nname = "judged"\nfile = "judged.csv"\nrole = "validation"\n'


def told(folder: Path, channels: str, of_run: str = "", of_judged: str = "") -> list[str]:
    for file, samples in (("run.csv", 60), ("judged.csv", 61)):
        rows = (f"{k},{k * k},{k + 0.5 * (k % 3)}" for k in range(samples))
        (folder / file).write_text("\n".join(["a,b,c", *rows]))
    card = f"sample_time = 0.01\n[channels]\n{channels}\n{RUN}{of_run}\n{JUDGED}{of_judged}\n"
    (folder / "dataset.toml").write_text(card)
    return [str(one) for one in data_warnings(load_dataset(folder / "dataset.toml"), None)]


def test_one_column_for_two_channels(tmp_path: Path) -> None:
    """Seen: a voltage from the column of a valve; the fit ended far off, and nothing said why."""
    (one,) = told(tmp_path, 'voltage = { column = "a", unit = "V" }\nvalve = { column = "a", unit = "mm" }')
    assert one.startswith('[channels] "voltage" [V] and "valve" [mm] are both read from "a"; write: the column of each')
    (one,) = told(tmp_path, 'u = { expr = "a + b" }\nv = { expr = "a + b" }\ny = { column = "c" }')
    assert '"u" and "v" are both read from "a + b"' in one


def test_what_to_write_is_what_a_card_takes(tmp_path: Path) -> None:
    """A line with a file_unit takes no scale."""
    both, of_u = '{{ column = "a", unit = "V"{} }}', ', file_unit = "mV"'
    (one,) = told(tmp_path, f"u = {both.format(of_u)}\nv = {both.format('')}")
    assert "or scale = 1.0 in the line that has no file_unit, if both are meant" in one
    (one,) = told(tmp_path, f"u = {both.format(of_u)}\nv = {both.format(of_u)}")
    assert "or expr with the factor, in the place of column and file_unit, in one of the two lines" in one


def test_in_one_experiment_alone(tmp_path: Path) -> None:
    (one,) = told(tmp_path, 'u = { column = "a" }\ny = { column = "b" }', of_judged='columns = { y = "a" }')
    assert one.startswith('[[experiment]] "judged", columns: "u" and "y" are both read from "a"')


@pytest.mark.parametrize(
    "channels",
    [
        'u = { column = "a" }\ny = { column = "b" }',
        'angle = { column = "a" }\nspeed = { column = "a", derivative = 10.0 }',
        'u = { column = "a" }\ny = { column = "a", scale = 1.0 }',
        'u = { column = "a" }\ny = { expr = "2 * a" }',
    ],
)
def test_nothing_is_told(tmp_path: Path, channels: str) -> None:
    assert told(tmp_path, channels) == []
