"""Files of a join are all named, and single samples that one of them lacks are told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

import greybox_torch as gt


@pytest.mark.parametrize(
    ("lost", "told"),
    [
        ((), "."),
        ((50,), ", also across 1 sample that is missing there (after line 51)."),
        ((20, 50, 51, 70, 90), ", also across 5 samples that are missing there (after lines 21, 50, 68, …)."),
    ],
)
def test_what_the_second_file_lacks(tmp_path: Path, lost: tuple[int, ...], told: str) -> None:
    """Seen: nothing was said of it, and the heading had the first file alone."""
    for name, columns in (("a.csv", "t,u"), ("b.csv", "t,y")):
        kept = [k for k in range(120) if name == "a.csv" or k not in lost]
        rows = np.column_stack([0.1 * np.array(kept), np.sin(kept)])
        np.savetxt(tmp_path / name, rows, "%.6g", ",", header=columns, comments="")
    (tmp_path / "dataset.toml").write_text(
        'time = "t"\n[channels]\nu = { column = "u" }\ny = { column = "y" }\n[[experiment]]\nname = "A"\nfile = ["a.csv", "b.csv"]\n'
        'join = "time"\n'
    )
    inspected = gt.inspect(gt.load_dataset(tmp_path / "dataset.toml"))
    with (console := Console(width=200)).capture() as captured:
        inspected.show(console)
    text = captured.get()
    assert "A (estimation): a.csv and b.csv, rows = [0, 90]" in text
    assert f"joined in time on straight lines between its samples{told}" in text
    assert "A (held out) (validation): a.csv and b.csv" in text


@pytest.mark.parametrize(
    ("clock", "begin", "told"),
    [
        (lambda k: 0.1 * k, 500.0, 'b.csv, column "t": is from 50 to 61.9, and a.csv is from 0 to 11.9'),
        (
            lambda k: f"{1 + int(k) // 24:02d}.04.2026 {int(k) % 24:02d}:00:00",
            240.0,
            'b.csv, column "t": is from 2026-04-11 00:00:00 to 2026-04-15 23:00:00, and a.csv is from 2026-04-01 00:00:00 to',
        ),
    ],
)
def test_files_without_a_time_in_common(
    tmp_path: Path, clock: Callable[[float], object], begin: float, told: str
) -> None:
    """Seen: "all 1728 samples are missing (NaN), rows [0, 1728] of april_klima.csv", of a column of maerz_wetter.csv."""
    for name, column, first in (("a.csv", "u", 0.0), ("b.csv", "y", begin)):
        rows = [f"{clock(first + k)},{np.sin(k):.4f}" for k in range(120)]
        (tmp_path / name).write_text("\n".join([f"t,{column}", *rows]))
    (tmp_path / "dataset.toml").write_text(
        'time = "t"\n[channels]\nu = { column = "u" }\ny = { column = "y" }\n[[experiment]]\nname = "A"\nfile = ["a.csv", "b.csv"]\n'
        'join = "time"\n'
    )
    with pytest.raises(gt.UserError) as raised:
        gt.load_dataset(tmp_path / "dataset.toml")
    assert told in str(raised.value) and "they have no time in common; expected files of one run" in str(raised.value)


def test_a_file_between_two_samples_of_the_first(tmp_path: Path) -> None:
    """Seen: "they have no time in common", of 130 to 139.9 s within 0 to 5940 s."""
    for name, column, stamps in (("a.csv", "u", 60.0 * np.arange(100)), ("b.csv", "y", 130 + 0.1 * np.arange(100))):
        np.savetxt(tmp_path / name, np.column_stack([stamps, stamps]), "%.6g", ",", header=f"t,{column}", comments="")
    (tmp_path / "dataset.toml").write_text(
        'time = "t"\n[channels]\nu = { column = "u" }\ny = { column = "y" }\n[[experiment]]\nname = "A"\nfile = ["a.csv", "b.csv"]\n'
        'join = "time"\n'
    )
    with pytest.raises(gt.UserError, match=r"from 0 to 5940: no sample of a\.csv lies within; .*the most samples"):
        gt.load_dataset(tmp_path / "dataset.toml")


def test_rows_that_a_joined_file_does_not_reach_are_told_with_that_file(tmp_path: Path) -> None:
    for name, column, count in (("a.csv", "u", 120), ("b.csv", "y", 50)):
        rows = np.column_stack([0.1 * np.arange(count), np.sin(np.arange(count))])
        np.savetxt(tmp_path / name, rows, "%.6g", ",", header=f"t,{column}", comments="")
    (tmp_path / "dataset.toml").write_text(
        'time = "t"\n[channels]\nu = { column = "u" }\ny = { column = "y" }\n[[experiment]]\nname = "A"\nfile = ["a.csv", "b.csv"]\n'
        'join = "time"\nrows = [60, 120]\n'
    )
    with pytest.raises(gt.UserError, match=r"samples are missing \(NaN\), rows \[60, .*\] of .*a\.csv with b\.csv;"):
        gt.load_dataset(tmp_path / "dataset.toml")
