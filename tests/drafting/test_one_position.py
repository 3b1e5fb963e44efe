"""Loggers that call their time stamps differently: a card names the column by its position."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.drafting.clock import Clock, clock_of
from greybox_torch.drafting.one_position import by_position
from greybox_torch.drafting.recorded import recorded


class Axis(gt.GreyBoxModel):
    states = [gt.State("position", "m")]
    inputs = [gt.Input("current", "A")]
    outputs = [gt.Output("position", "m"), gt.Output("speed", "m/s")]


def log(path: Path, clock: str, start: float, step: float, names: tuple[str, ...], *, last: bool = False) -> None:
    """A log of 12 s that begins at ``start``, with its clock in the first column, or in the ``last``."""
    rows, time = [], start + np.arange(0.0, 12.0, step)
    for t in time:
        cells = [f"{np.sin(t + k):.5f}" for k in range(len(names))]
        rows.append([*cells, f"{t:.4f}"] if last else [f"{t:.4f}", *cells])
    head = [*names, clock] if last else [clock, *names]
    path.write_text("\n".join(",".join(row) for row in [head, *rows]))


def two_loggers(folder: Path, second: str, *, last: bool = False) -> list[Path]:
    for k, run in enumerate("AB"):
        log(folder / f"drive_{run}.csv", "Zeit", 100.0 * k, 0.02, ("current", "speed"))
        log(folder / f"scale_{run}.csv", second, 100.0 * k + 0.004, 0.05, ("position",), last=last)
    return sorted(folder.glob("*.csv"))


def test_time_stamps_of_other_names_at_one_position_are_joined(tmp_path: Path) -> None:
    """Seen: "position: no column fits", of a file with a column of that name; the logs had to be edited to be joined."""
    card = gt.card(two_loggers(tmp_path, "time"), Axis())
    assert not card.open, card.open
    assert 'time = 1    # column 1 of each file, which is called "Zeit" or "time"; ' in card.text
    assert 'file = ["drive_A.csv", "scale_A.csv"]\njoin = "time"' in card.text
    assert card.to_dict()["time"] == 1
    card.save()
    data = gt.load_dataset(tmp_path / "dataset.toml")
    assert [(r.name, r.role) for r in data.recordings] == [("A", "estimation"), ("B", "validation")]
    known = data.recordings[0].measured("position")
    np.testing.assert_allclose(
        known[2:-2][~np.isnan(known[2:-2])], np.sin(data.recordings[0].time)[2:-2][~np.isnan(known[2:-2])], atol=1e-3
    )


@pytest.mark.parametrize(
    ("clock", "named"), [(Clock(column="#1"), "#1"), (Clock(), None), (Clock("#2", position=2), 2)]
)
def test_a_column_that_is_called_like_a_position_keeps_its_name(clock: Clock, named: str | int | None) -> None:
    assert clock.on_card == named


def test_one_name_stays_a_name(tmp_path: Path) -> None:
    assert 'time = "Zeit"' in gt.card(two_loggers(tmp_path, "Zeit"), Axis()).text


def test_at_other_positions_each_file_has_a_clock_of_its_own(tmp_path: Path) -> None:
    """Seen: an experiment of each, one for estimation and the other for validation."""
    card = gt.card(two_loggers(tmp_path, "time", last=True), Axis())
    assert not card.open and 'clocks = { "scale_A.csv" = { column = "time" } }' in card.text
    card.save()
    data = gt.load_dataset(tmp_path / "dataset.toml")
    assert [(r.name, r.role) for r in data.recordings] == [("A", "estimation"), ("B", "validation")]


def test_a_name_that_one_of_the_files_lacks_is_told_with_what_to_write(tmp_path: Path) -> None:
    gt.card(two_loggers(tmp_path, "time"), Axis()).save()
    place = tmp_path / "dataset.toml"
    place.write_text(place.read_text().replace("time = 1 ", 'time = "Zeit" '))
    with pytest.raises(gt.UserError, match=r'no column "Zeit".*time = 1 for the first column of each'):
        gt.load_dataset(place)


@pytest.mark.parametrize("other", [{"unit": "ms"}, {"date": "Datum"}, {"column": None}])
def test_other_units_and_dates_beside_the_time_have_no_one_position(tmp_path: Path, other: dict[str, Any]) -> None:
    files = [recorded(path) for path in two_loggers(tmp_path, "time")]
    clocks = [clock_of(file) for file in files]
    assert [clock.column for _, clock in by_position(files, clocks)] == ["#1"] * 4
    assert by_position(files, [*clocks[:-1], replace(clocks[-1], **other)]) == []


def test_runs_with_one_name_beside_runs_with_two(tmp_path: Path) -> None:
    """The one card has to read both."""
    files = two_loggers(tmp_path, "time")
    log(tmp_path / "scale_A.csv", "Zeit", 0.004, 0.05, ("position",))
    gt.card(files, Axis()).save()
    data = gt.load_dataset(tmp_path / "dataset.toml")
    assert [r.name for r in data.recordings] == ["A", "B"]
