"""Files that are joined in time and have little of it in common are refused or told, and so are counters that are read as time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.data_warnings import data_warnings

CARD = """[channels]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "m" }
[[experiment]]
name = "run"
role = "validation"
file = ["drive.csv", "logs/camera.csv"]
join = "time"
"""


def joined(
    folder: Path, drive: np.ndarray, camera: np.ndarray, more: str = "", top: str = 'time = "t"\n'
) -> gt.DataSet:
    """The files' signals are noise, which nothing else is told of."""
    random = np.random.default_rng(1)
    (folder / "logs").mkdir(exist_ok=True)
    clock = top.split('"')[1]
    for name, column, stamps in (("drive.csv", "u", drive), ("logs/camera.csv", "y", camera)):
        rows = np.column_stack([stamps, random.normal(size=len(stamps))])
        np.savetxt(folder / name, rows, "%.9g", ",", header=f"{clock},{column}", comments="")
    (folder / "dataset.toml").write_text(top + CARD + more)
    return gt.load_dataset(folder / "dataset.toml")


def told(data: gt.DataSet) -> list[str]:
    return [str(one) for one in data_warnings(data, None)]


DRIVE, CAMERA = 0.01 * np.arange(5000), 0.02 * np.arange(2500)


@pytest.mark.parametrize(
    ("drive", "camera", "top", "file", "unit"),
    [
        (1e3 * DRIVE, CAMERA, 'time = { column = "t", unit = "ms" }\n', "logs/camera.csv", "s"),
        (DRIVE, 1e3 * CAMERA, 'time = "t"\n', "logs/camera.csv", "ms"),
        (1e3 * DRIVE, CAMERA, 'time = "t"\n', "drive.csv", "ms"),
        (DRIVE, CAMERA / 60.0, 'time = "t"\n', "logs/camera.csv", "min"),
    ],
)
def test_another_unit_is_refused_with_what_to_write(
    tmp_path: Path, drive: np.ndarray, camera: np.ndarray, top: str, file: str, unit: str
) -> None:
    """Seen: 4996 of 5000 samples missing, and neither `check` nor `inspect` said a word."""
    with pytest.raises(gt.UserError) as raised:
        joined(tmp_path, drive, camera, top=top)
    write = f'clocks = {{ "{file}" = {{ unit = "{unit}" }} }}'
    assert f"they have hardly any time in common; expected {write} in that [[experiment]]" in str(raised.value)
    assert not told(joined(tmp_path, drive, camera, write + "\n", top))
    with pytest.raises(gt.UserError, match="they have hardly any time in common"):
        joined(tmp_path, drive, camera, "rows = [4500, 5000]\n", top)


def test_a_unit_that_is_given_counts_and_what_is_missing_is_told(tmp_path: Path) -> None:
    data = joined(tmp_path, DRIVE, 1e3 * CAMERA, 'clocks = { "logs/camera.csv" = { unit = "s" } }\n')
    (line,) = told(data)
    assert '[[experiment]] "run": 3 of the 2500 samples of camera.csv lie within the time of drive.csv' in line
    assert 'clocks = { "logs/camera.csv" = { unit = "…", offset = … } }' in line


def test_another_zero_is_told(tmp_path: Path) -> None:
    (line,) = told(joined(tmp_path, DRIVE + 30.0, CAMERA))
    assert '1999 of 5000 samples lie within the time of camera.csv; what it has ("y") is missing in the others' in line
    assert "camera.csv is from 0 to 49.98 s, the experiment from 30 to 79.99 s" in line and "rows = [0, 1999]" in line
    assert not told(joined(tmp_path, DRIVE + 10.0, CAMERA))
    with pytest.raises(
        gt.UserError, match=r"all .* missing .*; where the stamps of camera.csv are in another unit, or begin at"
    ):
        joined(tmp_path, DRIVE + 30.0, CAMERA, "rows = [4000, 5000]\n")
    with pytest.raises(gt.UserError, match=r'no time in common; .*"logs/camera.csv" = { offset = 100 } }'):
        joined(tmp_path, DRIVE + 100.0, CAMERA)


def test_rows_of_a_long_file_beside_a_short_one(tmp_path: Path) -> None:
    """What is outside of the rows is not of the experiment."""
    whole = 0.01 * np.arange(50000)
    assert told(joined(tmp_path, whole, CAMERA))
    assert not told(joined(tmp_path, whole, CAMERA, "rows = [0, 4990]\n"))
    assert not told(joined(tmp_path, DRIVE, np.arange(0.0, 900.0)))  # a slow log of all day
    day = np.arange(0.0, 86400.0, 2.0)
    assert not told(joined(tmp_path, day, day, "rows = [10, 40]\n"))  # 20 to 78 s, 2/3 of a day that is read in ms


def test_a_counter_is_no_time(tmp_path: Path) -> None:
    """Seen: "frame" of a camera, taken for seconds."""
    counts = np.arange(3000.0)
    (line,) = told(joined(tmp_path, counts, counts, top='time = "frame"\n'))
    assert line.startswith(
        'time: column "frame" counts samples by its name and values, and is read as time stamps in s'
    )
    assert "sample_time = <seconds" in line
    assert not told(joined(tmp_path, 0.01 * counts, 0.01 * counts, top='time = "frame"\n'))
    assert not told(joined(tmp_path, counts, counts, top='time = "stamp"\n'))


NOTHING_FROM_IT = 'y = { column = "u", scale = 2, unit = "m" }'


@pytest.mark.parametrize(
    ("camera", "rows", "told_of"),
    [
        (
            CAMERA[:400],
            "rows = [1000, 3000]\n",
            "0 of the 400 samples of camera.csv lie within the time of drive.csv: ",
        ),
        (np.array([0.505]), "", "0 of 5000 samples lie within the time of camera.csv: "),
    ],
)
def test_a_file_of_which_nothing_is_read(
    tmp_path: Path, camera: np.ndarray, rows: str, told_of: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seen: IndexError from `check`, where no sample of the experiment lies within the time of a file."""
    monkeypatch.setattr(f"{__name__}.CARD", CARD.replace('y = { column = "y", unit = "m" }', NOTHING_FROM_IT))
    (line,) = told(joined(tmp_path, DRIVE, camera, rows))
    assert told_of in line and line.endswith("else rows within its time")


@pytest.mark.parametrize("entry", ['y = { column = "y", unit = "m" }', NOTHING_FROM_IT])
def test_a_joined_file_without_samples(tmp_path: Path, entry: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: "array of sample points is empty", an error of NumPy."""
    monkeypatch.setattr(f"{__name__}.CARD", CARD.replace('y = { column = "y", unit = "m" }', entry))
    with pytest.raises(gt.UserError, match=r"camera\.csv: has no samples; expected lines of numbers below its header"):
        joined(tmp_path, DRIVE, CAMERA[:0])
