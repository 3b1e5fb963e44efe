"""Files that are joined in time whose time stamps have a name, a unit, dates or a zero of their own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt

CHANNELS = """
[channels]
current = { column = "current", unit = "A" }
position = { column = "position", unit = "m" }
"""
DRIVE, CAMERA = 0.01 * np.arange(3000), 0.02 * np.arange(1500)
JOINED = CHANNELS + '[[experiment]]\nname = "A"\nfile = ["drive.csv", "camera.csv"]\njoin = "time"\n'


def date(seconds: float) -> str:
    return str(np.datetime64("2026-03-01T12:00:00.000") + np.timedelta64(round(1000 * seconds), "ms"))


def seconds(value: float) -> str:
    return f"{value:.6f}"


def write(file: Path, names: str, time: np.ndarray, stamp: Callable[[float], str]) -> None:
    """Every column is the sine of the time in s."""
    columns = names.count(",") + 1 - stamp(0.0).count(",") - 1
    rows = [",".join([stamp(t), *[f"{np.sin(t):.7f}"] * columns]) for t in time]
    file.write_text("\n".join([names, *rows]))


def loaded(folder: Path, top: str, more: str = "") -> gt.DataSet:
    (folder / "dataset.toml").write_text(top + JOINED + more)
    return gt.load_dataset(folder / "dataset.toml")


def check_position(data: gt.DataSet, begin: float = 0.0) -> None:
    (run, _) = data.recordings
    np.testing.assert_allclose(run.signals["position"], np.sin(run.time - begin), atol=1e-4)


@pytest.mark.parametrize(
    ("name", "stamp", "clock"),
    [
        ("t", lambda t: seconds(1e3 * t), 'unit = "ms"'),
        ("stamp", seconds, 'column = "stamp"'),
        ("stamp", seconds, "column = 1"),
        ("stamp", lambda t: seconds(1e3 * t), 'column = "stamp", unit = "ms"'),
        ("stamp", lambda t: seconds(1e6 * (t - 5.0)), 'column = "stamp", unit = "us", offset = 5'),
        ("t", lambda t: seconds(t + 100.0), "offset = -100.0"),
    ],
)
def test_a_clock_of_its_own(tmp_path: Path, name: str, stamp: Callable[[float], str], clock: str) -> None:
    """Seen: stamps had to have one name and one unit, and files were to be edited."""
    write(tmp_path / "drive.csv", "t,current", DRIVE, seconds)
    write(tmp_path / "camera.csv", f"{name},position", CAMERA, stamp)
    data = loaded(tmp_path, 'time = "t"', f'clocks = {{ "camera.csv" = {{ {clock} }} }}')
    check_position(data)


def test_the_first_file_has_a_clock_of_its_own(tmp_path: Path) -> None:
    write(tmp_path / "drive.csv", "t,current", DRIVE, lambda t: seconds(1e3 * t))
    write(tmp_path / "camera.csv", "t,position", CAMERA, seconds)
    data = loaded(
        tmp_path, 'time = "t"', 'clocks = { "drive.csv" = { unit = "ms", offset = 2 }, "camera.csv" = { offset = 2 } }'
    )
    check_position(data, begin=2.0)
    assert data.recordings[0].time[[0, 100]] == pytest.approx([2.0, 3.0])


def test_dates_in_one_of_them(tmp_path: Path) -> None:
    write(tmp_path / "drive.csv", "Date,Time,current", DRIVE, lambda t: date(t).replace("T", ","))
    write(tmp_path / "camera.csv", "stamp,position", CAMERA, date)
    top = 'time = { column = "Time", date = "Date" }'
    check_position(loaded(tmp_path, top, 'clocks = { "camera.csv" = { column = "stamp" } }'), begin=1772366400.0)
    write(tmp_path / "camera.csv", "stamp,position", CAMERA, seconds)
    clock = 'clocks = { "camera.csv" = { column = "stamp", offset = 1772366400 } }'
    check_position(loaded(tmp_path, top, clock), begin=1772366400.0)
    with pytest.raises(
        gt.UserError, match=r'have no time in common; .*column = "stamp", offset = 1772366400 } } in that'
    ):
        loaded(tmp_path, top, clock.replace(", offset = 1772366400", ""))


def test_a_unit_that_the_file_contradicts(tmp_path: Path) -> None:
    write(tmp_path / "drive.csv", "t,current", DRIVE, seconds)
    (tmp_path / "camera.csv").write_text("t,position\nms,m\n" + "\n".join(f"{1e3 * t},{np.sin(t)}" for t in CAMERA))
    with pytest.raises(
        gt.UserError, match=r'column "t" in "ms", the card says "s"; expected clocks = { "camera.csv" = '
    ):
        loaded(tmp_path, 'time = "t"')
    with pytest.raises(gt.UserError, match=r'in "ms", the card says "us"; .*{ column = "t", unit = "ms" }'):
        loaded(tmp_path, 'time = "t"', 'clocks = { "camera.csv" = { unit = "us" } }')
    check_position(loaded(tmp_path, 'time = "t"', 'clocks = { "camera.csv" = { unit = "ms" } }'))


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ('clocks = { "camra.csv" = { unit = "s" } }', r'no file "camra.csv" \(did you mean "camera.csv"\?\)'),
        ('clocks = { "camera.csv" = { unt = "s" } }', r'unknown key "unt" \(did you mean "unit"\?\)'),
        ('clocks = { "camera.csv" = { unit = "d" } }', "found .*d.*, expected"),
    ],
)
def test_what_a_card_may_not_say(tmp_path: Path, more: str, told: str) -> None:
    with pytest.raises(gt.UserError, match=told):
        loaded(tmp_path, 'time = "t"', more)


def test_single_files_have_columns(tmp_path: Path) -> None:
    one = '[[experiment]]\nname = "A"\nfile = "a.csv"\nclocks = { "a.csv" = { unit = "s" } }\n'
    (tmp_path / "dataset.toml").write_text('time = "t"' + CHANNELS + one)
    with pytest.raises(gt.UserError, match=r"expected columns = { time = … } for a single file"):
        gt.load_dataset(tmp_path / "dataset.toml")


@pytest.mark.parametrize(
    ("names", "stamp"),
    [
        ("Timestamp,current,position", date),
        ("Timestamp,current,position", seconds),
        ("Date,Timestamp,current,position", lambda t: date(t).replace("T", ",")),
    ],
)
def test_dates_of_the_card_are_of_files_that_have_them(
    tmp_path: Path, names: str, stamp: Callable[[float], str]
) -> None:
    """Seen: "no column "Date"" of an experiment with time stamps of its own, and no way to say that it has none."""
    write(tmp_path / "a.csv", "Date,Time,current,position", DRIVE, lambda t: date(t).replace("T", ","))
    write(tmp_path / "b.csv", names, DRIVE, stamp)
    of = '[[experiment]]\nname = "{0}"\nfile = "{0}.csv"\n'
    own = of.format("b") + 'role = "validation"\ncolumns = { time = "Timestamp" }\n'
    (tmp_path / "dataset.toml").write_text(
        'time = { column = "Time", date = "Date" }' + CHANNELS + of.format("a") + own
    )
    first, second = gt.load_dataset(tmp_path / "dataset.toml").recordings
    dated = 1772366400.0 * (stamp is not seconds)
    assert first.time[0] == 1772366400.0 and second.time[[0, 100]] == pytest.approx([dated, dated + 1.0])


def test_a_file_is_told_with_its_own_column(tmp_path: Path) -> None:
    write(tmp_path / "drive.csv", "t,current", DRIVE, seconds)
    write(tmp_path / "camera.csv", "stamp,position", CAMERA + 500.0, seconds)
    with pytest.raises(gt.UserError, match=r'camera.csv, column "stamp": is from 500 to'):
        loaded(tmp_path, 'time = "t"', 'clocks = { "camera.csv" = { column = "stamp" } }')
