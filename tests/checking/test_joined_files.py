"""Gaps and error values of a file that is joined in time are told with its own lines, and not by what the join made of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.joined_files import joined_files
from greybox_torch.data import load_dataset
from greybox_torch.data.readers import read_table
from greybox_torch.errors import UserError

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
    assert "1200 s after the start (" in gap and 'what it has ("y", "z") is missing there' in gap and len(gap) < 480
    assert "rows = [0, 248] and rows = [300, 1000]" in gap
    (run, _) = load_dataset(card).recordings
    assert np.isnan(run.signals["y"][248:300]).all() and not np.isnan(run.signals["y"][[247, 300]]).any()


def test_a_gap_in_the_part_that_is_held_out(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, dict.fromkeys(range(350, 370)))
    (gap,) = told(card)
    assert '"run (held out)": encoder.csv, line 351: ' in gap and "from 490 to 700 s after the start (" in gap


def missing(card: Path) -> list[int]:
    return [int(np.isnan(run.signals["y"]).sum()) for run in load_dataset(card).recordings]


def test_no_gap_where_none_is_in_the_data(card: Path) -> None:
    """Long steps are the rule in the whole file, though not in the part that is not held out."""
    kept = [0, 1, 2, 3, 360, 399]
    write(card.parent / "encoder.csv", "t,y,z", 10, {k: None for k in range(400) if k not in kept})
    assert missing(card) == [0, 2] and told(card) == []


def test_gaps_that_would_be_the_rule_in_the_rows_alone(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, dict.fromkeys([*range(50, 57), *range(65, 72)]))
    card.write_text(card.read_text() + "rows = [100, 220]\n")
    assert missing(card) == [39, 0]
    (gap,) = told(card)
    assert "line 51: " in gap and "no sample for 80 s" in gap and "the longest of 2 gaps" in gap
    assert "rows = [100, 123] and rows = [143, 220]" in gap


def test_a_gap_over_the_split_is_told_once(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, dict.fromkeys(range(290, 310)))
    assert missing(card) == [27, 27]
    (gap,) = told(card)
    assert '"run": encoder.csv, line 291: ' in gap and "from 2890 to 3100 s after the start" in gap


def test_a_gap_that_the_rows_begin_in(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, dict.fromkeys(range(100, 120)))
    card.write_text(card.read_text() + "rows = [275, 800]\n")
    (gap,) = told(card)
    assert "no sample for 100 s, from 0 to 100 s after the start" in gap and gap.endswith(
        "write: rows = [300, 800], if an input is among these"
    )


def test_every_file_is_read_again_once(card: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, read = load_dataset(card), []
    monkeypatch.setattr(
        "greybox_torch.checking.joined_files.read_table", lambda *of: (read_table(*of), read.append(of[0].name))[0]
    )
    data_warnings(data, None)
    assert sorted(read) == ["drive.csv", "encoder.csv"]


def test_a_gap_and_a_derivative(card: Path) -> None:
    write(card.parent / "encoder.csv", "t,y,z", 10, dict.fromkeys(range(100, 120)))
    card.write_text(
        card.read_text().replace('y = { column = "y", unit = "m"', 'y = { column = "y", unit = "m", derivative = 0.01')
    )
    with pytest.raises(UserError) as error:
        load_dataset(card)
    assert str(error.value).endswith(
        f'channel "y", derivative: {card.parent / "encoder.csv"}, line 101, column "y", sample 99 (the first is 0) is followed by a gap; '
        "expected no gap where a derivative is asked for: two experiments in place of this one: rows = [0, 248] and rows = [300, 1000]"
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
