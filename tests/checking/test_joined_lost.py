"""Files of a join are all named, and single samples that one of them lacks are told."""

from __future__ import annotations

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
