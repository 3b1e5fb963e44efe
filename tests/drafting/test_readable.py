"""What `card` writes is read by `check` and `inspect`, whatever the time stamps of the files are called; else it says why not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt

TIME = 0.01 * np.arange(2000)


class Axis(gt.GreyBoxModel):
    states = [gt.State("position", "m")]
    inputs = [gt.Input("current", "A")]
    outputs = [gt.Output("position", "m"), gt.Output("speed", "m/s")]


def date(seconds: float) -> str:
    return str(np.datetime64("2026-03-01T12:00:00.000") + np.timedelta64(round(1000 * seconds), "ms"))


def in_two(seconds: float) -> str:
    return date(seconds).replace("T", ",")


def plain(seconds: float) -> str:
    return f"{seconds:.6f}"


def in_ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3f}"


Stamp = Callable[[float], str]


def log(file: Path, clock: str, stamp: Stamp, *names: str, time: np.ndarray = TIME, begin: float = 0.0) -> Path:
    """Every channel is a sine of the time, the k-th ahead by k."""
    ahead = {"current": 0, "position": 1, "speed": 2}
    rows = [
        ",".join([*filter(None, [stamp(t + begin)]), *(f"{np.sin(t + ahead[n]):.6f}" for n in names)]) for t in time
    ]
    file.write_text("\n".join([",".join([*filter(None, [clock]), *names]), *rows]))
    return file


ALL = ("current", "position", "speed")
PAIR, OTHER_PAIR = ("Date,Time", in_two), ("Datum,Uhrzeit", in_two)


@pytest.mark.parametrize(
    ("first", "second", "columns"),
    [
        (PAIR, ("Timestamp", date), '"Timestamp"'),
        (("Timestamp", date), PAIR, '{ column = "Time", date = "Date" }'),
        (PAIR, OTHER_PAIR, '{ column = "Uhrzeit", date = "Datum" }'),
        (PAIR, ("t", plain), '"t"'),
        (PAIR, ("Time", date), '"Time"'),
        (PAIR, ("Time", lambda t: date(t)[11:]), '"Time"'),
        (PAIR, ("time_ms", in_ms), '{ column = "time_ms", unit = "ms" }'),
        (("time_ms", in_ms), PAIR, '{ column = "Time", unit = "s", date = "Date" }'),
    ],
)
def test_dates_and_stamps_of_other_names(
    tmp_path: Path, first: tuple[str, Stamp], second: tuple[str, Stamp], columns: str
) -> None:
    """Seen: a card with nothing left open that `check` refused: no column "Date" in the second file."""
    card = gt.card([log(tmp_path / "a.csv", *first, *ALL), log(tmp_path / "b.csv", *second, *ALL)], Axis())
    assert not card.open, card.open
    assert f"columns = {{ time = {columns} }}" in card.text
    card.save()
    for run in gt.load_dataset(tmp_path / "dataset.toml").recordings:
        np.testing.assert_allclose(run.time - run.time[0], TIME, atol=1e-6)


def test_what_cannot_be_read_is_said(tmp_path: Path) -> None:
    """Seen: nothing open, and the card refused."""
    files = [log(tmp_path / "a.csv", "t", plain, *ALL), log(tmp_path / "b.csv", "", lambda t: "", *ALL)]
    (told,) = gt.card(files, Axis()).open
    assert told.startswith('the card is refused as it is: [[experiment]] "b", time: ') and 'no column "t"' in told


def test_sample_times_that_differ_are_said(tmp_path: Path) -> None:
    """Seen: two files of which each says its sample time, and a card with that of the first for both."""
    for name, step in (("a", 0.01), ("b", 0.02), ("c", 0.01)):
        np.savez(tmp_path / f"{name}.npz", Ts=step, current=TIME % 1.0, position=TIME % 2.0, speed=TIME % 3.0)
    (told,) = gt.card([tmp_path / f"{name}.npz" for name in "abc"], Axis()).open
    assert told.startswith('[[experiment]] "b": Ts = 0.02 in b.npz, and sample_time = 0.01 s goes for all experiments')
    assert not gt.card([tmp_path / "a.npz", tmp_path / "c.npz"], Axis()).open
    assert (
        "columns = { time" not in gt.card([tmp_path / "a.npz", log(tmp_path / "d.csv", "t", plain, *ALL)], Axis()).text
    )


CAMERA = 0.02 * np.arange(1000)


@pytest.mark.parametrize(
    ("drive", "camera", "clock"),
    [
        (("t", plain), ("stamp_ms", in_ms), 'column = "stamp_ms", unit = "ms"'),
        (("t", plain), ("frame,ts_ms", lambda t: f"{round(50 * t)},{in_ms(t)}"), 'column = "ts_ms", unit = "ms"'),
        (PAIR, ("Timestamp", date), 'column = "Timestamp"'),
        (("Timestamp", date), PAIR, 'column = "Time", date = "Date"'),
    ],
)
def test_a_drive_and_a_camera_are_one_experiment(
    tmp_path: Path, drive: tuple[str, Stamp], camera: tuple[str, Stamp], clock: str
) -> None:
    """Seen: the drive's log for estimation, the camera's for validation; and `frame`, a counter, taken for its time."""
    files: list[Path] = []
    for k, begin in enumerate((0.0, 100.0)):
        files += [log(tmp_path / f"drive_{k}.csv", *drive, "current", "speed", begin=begin)]
        files += [log(tmp_path / f"camera_{k}.csv", *camera, "position", time=CAMERA, begin=begin)]
    card = gt.card(files, Axis())
    assert not card.open, card.open
    assert f'clocks = {{ "camera_1.csv" = {{ {clock} }} }}' in card.text
    assert card.to_dict()["runs"][1]["clocks"][str(files[3])]["column"] in clock
    card.save()
    runs = gt.load_dataset(tmp_path / "dataset.toml").recordings
    assert [(run.name, run.role) for run in runs] == [("0", "estimation"), ("1", "validation")]
    for run in runs:
        np.testing.assert_allclose(run.signals["position"][:-2], np.sin(TIME + 1)[:-2], atol=1e-3)


@pytest.mark.parametrize(
    ("names", "stamps", "joined"),
    [
        (("run1_drive", "run1_camera"), (("t", plain), ("stamp_ms", in_ms)), True),
        (("drive", "camera"), (PAIR, ("Timestamp", date)), True),
        (("drive", "camera"), (("t", plain), ("stamp_ms", in_ms)), False),
    ],
)
def test_without_a_model_names_or_dates_tell_what_is_one_run(
    tmp_path: Path, names: tuple[str, str], stamps: tuple[tuple[str, Stamp], tuple[str, Stamp]], joined: bool
) -> None:
    drive = log(tmp_path / f"{names[0]}.csv", *stamps[0], "current", "speed")
    camera = log(tmp_path / f"{names[1]}.csv", *stamps[1], "position", time=CAMERA)
    card = gt.card([drive, camera])
    assert ('join = "time"' in card.text) is joined and bool(card.open) is not joined
    if joined:
        card.save()
        assert set(gt.load_dataset(tmp_path / "dataset.toml").channels) == set(ALL)
    else:
        assert "have different channels; if they are of one run, one experiment with both" in card.open[0]


def test_a_counter_alone_is_no_clock(tmp_path: Path) -> None:
    log(tmp_path / "a.csv", "frame", lambda t: str(round(100 * t)), *ALL)
    (told,) = gt.card(tmp_path / "a.csv", Axis()).open
    assert told.startswith('sample_time: column "frame" counts samples, and is no time; ')
    log(tmp_path / "b.csv", "frame", lambda t: str(round(100 * t)), "position")
    told = gt.card([log(tmp_path / "c.csv", "t", plain, "current", "speed"), tmp_path / "b.csv"], Axis()).open[-1]
    assert 'clocks = { "b.csv" = { column = "…", unit = "…", offset = … } }' in told


def test_what_was_held_out_is_said(tmp_path: Path) -> None:
    files = [log(tmp_path / f"{name}.csv", "t", plain, *ALL) for name in ("steps", "sweep")]
    card = gt.card(files, Axis())
    assert card.to_dict()["held_out"].startswith(
        '"sweep" is for validation, as the last file. Where the experiments differ'
    )
    assert "# results are judged on it; chosen as the last file" in card.text
    assert gt.card(files[0], Axis()).to_dict()["held_out"] == 'the last quarter of "steps"'


class Motor(gt.GreyBoxModel):
    states = [gt.State("speed", "rad/s")]
    inputs = [gt.Input("current", "A")]
    outputs = [gt.Output("speed", "rad/s")]


@pytest.mark.parametrize(("size", "unit"), [(1.0, "rpm"), (0.1047, ""), (0.33, None)])
def test_a_unit_that_another_file_says(tmp_path: Path, size: float, unit: str | None) -> None:
    """Seen: a speed in rpm without a unit in the first file, read as rad/s, though the second file says rpm."""
    speed = 300.0 * np.sin(TIME)
    for name, column, factor in (("a", "speed", size), ("b", "speed [rpm]", 1.0)):
        rows = np.column_stack([TIME, np.cos(TIME), factor * speed])
        np.savetxt(tmp_path / f"{name}.csv", rows, "%.6f", ",", header=f"t,current,{column}", comments="")
    card = gt.card([tmp_path / "a.csv", tmp_path / "b.csv"], Motor())
    line = next(row for row in card.rows if row["channel"] == "speed")
    assert line["file_unit"] == (unit or "")
    assert bool(card.open) is (unit != ""), card.open
    if card.open:
        said = "rpm by its size beside that of" if unit else 'and "speed [rpm]" of b.csv is in rpm'
        assert said in card.open[0] and said in line["remark"]
    card.save()
    first, second = gt.load_dataset(tmp_path / "dataset.toml").recordings
    same = first.signals["speed"] / (size if unit is None else 1.0) * (np.pi / 30 if unit is None else 1.0)
    np.testing.assert_allclose(same, second.signals["speed"], rtol=1e-3, atol=1e-3)


def test_a_unit_that_nobody_knows_is_remarked(tmp_path: Path) -> None:
    """Seen: passed over, and the values taken for rad/s."""
    rows = "\n".join(f"{t:.2f},1,{np.sin(t):.5f}" for t in TIME)
    (tmp_path / "a.csv").write_text(f"t,current,speed\ns,A,knack/s\n{rows}")
    card = gt.card(tmp_path / "a.csv", Motor())
    assert 'of the unknown unit "knack/s", which is not converted; please check' in card.text
