"""Gaps and error values of a file that is joined in time are told with its own lines, and not by what the join made of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.joined_files import joined_files
from greybox_torch.data import load_dataset

CARD = """time = "t"
[channels]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "m" }
z = { expr = 'col("z") - 1', unit = "m" }
[[experiment]]
name = "run"
file = ["drive.csv", "encoder.csv"]
join = "time"
"""


@pytest.fixture
def card(tmp_path: Path) -> Path:
    """Drive at 4 s, encoder at 10 s, over 4000 s from a date on."""
    write(tmp_path / "drive.csv", "t,u", 4, {})
    write(tmp_path / "encoder.csv", "t,y,z", 10, {})
    (tmp_path / "dataset.toml").write_text(CARD)
    return tmp_path / "dataset.toml"


def write(file: Path, names: str, step: int, rows: dict[int, str | None]) -> None:
    """``rows`` are by sample, None of those that the logger did not write."""
    many = 4000 // step
    stamps = [
        f"2026-03-02T{8 + k * step // 3600:02d}:{k * step // 60 % 60:02d}:{k * step % 60:02d}" for k in range(many)
    ]
    values = [[float(np.sin(0.01 * k * step + c)) for c in range(names.count(","))] for k in range(many)]
    cells = {k: ",".join(f"{v:.4f}" for v in row) for k, row in enumerate(values)} | rows
    file.write_text("\n".join([names, *(f"{stamps[k]},{row}" for k, row in cells.items() if row is not None)]) + "\n")


def told(card: Path) -> list[str]:
    return [str(one) for one in data_warnings(load_dataset(card), None)]


def test_nothing_is_told_of_whole_files(card: Path) -> None:
    assert told(card) == []


def test_a_gap(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, dict.fromkeys(range(100, 120)))
    (gap,) = told(card)
    assert (
        '[[experiment]] "run": encoder.csv, line 101: gap in the time stamps: no sample for 210 s, from 990 to 1200 s'
        in gap
    )
    assert (
        "(after sample 99, the first is 0; usual step 10 s)" in gap and 'what it has ("y", "z") is missing there' in gap
    )
    assert "rows = [0, 248] and rows = [300, 1000]" in gap
    (run, _) = load_dataset(card).recordings
    assert np.isnan(run.signals["y"][248:300]).all() and not np.isnan(run.signals["y"][[247, 300]]).any()


def test_a_gap_in_the_part_that_is_held_out(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, dict.fromkeys(range(350, 370)))
    (gap,) = told(card)
    assert (
        '"run (held out)": encoder.csv, line 351: ' in gap
        and "from 490 to 700 s after the start (after sample 349" in gap
    )


def test_error_values(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, {150: "-9999,0.5", 350: "0.5,65535"})
    first, last = told(card)
    file = card.parent / "encoder.csv"
    assert (
        f'"run", channel "y": {file}, line 152, column "y", sample 150 (the first is 0): found -9999 between' in first
    )
    assert (
        f'"run (held out)", channel "z": {file}, line 352, column "z", sample 350' in last
        and "found 65535 between" in last
    )


def test_error_values_of_the_first_file_and_of_files_one_after_the_other(card: Path) -> None:
    drive = card.parent / "drive.csv"
    write(drive, "t,u", 4, {150: "-9999"})
    (one,) = told(card)
    assert f'{drive}, line 152, column "u", sample 150 (the first is 0): found -9999 between' in one
    again = card.parent / "again.csv"
    again.write_text(drive.read_text().replace("2026-03-02", "2026-03-03"))
    write(drive, "t,u", 4, {})
    lines = [line for line in CARD.splitlines() if not line.startswith(("y =", "z ="))]
    joined = 'file = ["drive.csv", "again.csv"]\njoin = "concatenate"\nrows = [900, 1900]'
    text = "\n".join(lines[:-2]) + "\n" + joined + "\n"
    card.write_text(text)
    assert any(f'{again}, line 152, column "u", sample 150' in line for line in told(card))


@pytest.mark.parametrize("change", ["no card", "no channel", "no file"])
def test_files_that_were_replaced_meanwhile(card: Path, change: str) -> None:
    data = load_dataset(card)
    if change == "no card":
        card.write_text("[channels")
    elif change == "no channel":
        card.write_text(CARD.replace("y = {", "x = {"))
    else:
        (card.parent / "encoder.csv").unlink()
    assert joined_files(data) == {}
