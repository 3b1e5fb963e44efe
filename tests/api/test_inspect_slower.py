"""What `inspect` says of a sensor that is slower than the rest, in a file of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt

CARD = 'time = "t"\n[channels]\nu = { column = "u" }\ny = { column = "y" }\n'


def recorded(folder: Path, gone: tuple[int, ...] = ()) -> gt.DataSet:
    """Inputs every 2 ms, and an output every 5 ms from 0.4 ms on, which lacks the values ``gone``; two experiments of two files each."""
    card = CARD
    for name in ("A", "B"):
        for file, column, t in (("fast", "u", 0.002 * np.arange(600)), ("slow", "y", 0.0004 + 0.005 * np.arange(240))):
            cells = ["" if column == "y" and k in gone else f"{np.sin(20 * v):.6f}" for k, v in enumerate(t)]
            rows = [f"{v:.4f},{cell}" for v, cell in zip(t, cells, strict=True)]
            (folder / f"{file}_{name}.csv").write_text("\n".join([f"t,{column}", *rows]) + "\n")
        card += f'[[experiment]]\nname = "{name}"\nfile = ["fast_{name}.csv", "slow_{name}.csv"]\njoin = "time"\n'
    (folder / "dataset.toml").write_text(card)
    return gt.load_dataset(folder / "dataset.toml")


def test_a_line_that_differs_in_the_file_alone_is_told_once(tmp_path: Path) -> None:
    """Seen: three times the same, with the lines of all experiments between them."""
    lines = str(gt.inspect(recorded(tmp_path))).splitlines()
    (told,) = [line for line in lines if "joined in time" in line]
    # the held out quarters of both are of the same files
    assert 'column "y" is from slow_A.csv and slow_B.csv, joined in time on straight lines between its samples.' in told
    assert told.startswith("A, ") and told.count("slow_A.csv") == 1


@pytest.mark.parametrize("gone", [(), (100,), (100, 101, 150)])
def test_samples_of_a_slower_sensor_are_its_own(tmp_path: Path, gone: tuple[int, ...]) -> None:
    """Seen: "samples 6000, missing 3" of a sensor with 2400, of which none was missing."""
    data = recorded(tmp_path, gone)
    rows = [row for row in gt.inspect(data).rows if row["experiment"].startswith("A")]
    of = {name: [row for row in rows if row["channel"] == name] for name in ("u", "y")}
    assert sum(row["samples"] for row in of["u"]) == 600 and sum(row["samples"] for row in of["y"]) == 240
    # on straight lines a neighbour whose row lies towards one that is missing has no value, either
    assert len(gone) <= sum(row["missing"] for row in of["y"]) <= 2 * len(gone)
    assert {round(row["sample_time"], 4) for row in of["y"]} == {0.005}
