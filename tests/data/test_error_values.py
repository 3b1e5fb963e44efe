"""Numbers that the card says are missing samples are read as such, before anything is done to them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.data import DataSet, load_dataset
from greybox_torch.errors import UserError

TIME: np.ndarray = 0.01 * np.arange(400)
ANGLE: np.ndarray = 30.0 + 20.0 * np.sin(TIME)
HEAD, TAIL = (
    'time = "t"\n[channels]\nu = { column = "u", unit = "V" }\n',
    '\n[[experiment]]\nname = "run"\nrole = "validation"\n',
)


def loaded(folder: Path, channel: str, file: str = 'file = "a.csv"') -> DataSet:
    (folder / "dataset.toml").write_text(f"{HEAD}q = {{ {channel} }}{TAIL}{file}\n")
    return load_dataset(folder / "dataset.toml")


def written(folder: Path, name: str, **columns: np.ndarray) -> None:
    rows = [",".join(repr(float(v)) for v in row) for row in zip(*columns.values(), strict=True)]
    (folder / name).write_text("\n".join([",".join(columns), *rows]))


def damaged() -> np.ndarray:
    values = ANGLE.copy()
    values[[100, 250]], values[300] = 359.978, -9999.0
    return values


@pytest.mark.parametrize(
    ("channel", "gone"),
    [
        ('column = "q", unit = "rad", file_unit = "deg", missing = 359.978', [100, 250]),
        ('column = "q", unit = "rad", file_unit = "deg", missing = [359.978, -9999]', [100, 250, 300]),
        ('expr = "q + 0 * u", unit = "deg", missing = [359.978, -9999]', [100, 250, 300]),
    ],
)
def test_numbers_of_the_file_that_are_missing_samples(tmp_path: Path, channel: str, gone: list[int]) -> None:
    written(tmp_path, "a.csv", t=TIME, u=np.cos(TIME), q=damaged())
    found = loaded(tmp_path, channel).recordings[0].signals
    assert np.flatnonzero(np.isnan(found["q"])).tolist() == gone and not np.isnan(found["u"]).any()


def test_in_single_precision_and_a_derivative_of_files_joined_in_time(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", t=TIME, u=np.cos(TIME), q=damaged().astype(np.float32))
    channel = 'column = "q", unit = "deg", missing = [359.978, -9999]'
    data = loaded(tmp_path, channel, 'file = "a.npz"')
    assert np.isnan(data.recordings[0].signals["q"]).sum() == 3
    written(tmp_path, "b.csv", t=TIME, u=np.cos(TIME))
    written(tmp_path, "c.csv", t=TIME + 0.004, q=damaged())
    joined = 'file = ["b.csv", "c.csv"]\njoin = "time"'
    told = [
        one
        for one in data_warnings(loaded(tmp_path, 'column = "q", unit = "deg"', joined), None)
        if "loggers" in one.found
    ]
    assert told and "missing = -9999 in the channel's line" in told[0].write
    data = loaded(tmp_path, channel, joined)
    known = data.recordings[0].signals["q"]
    assert np.nanmax(known) < 51.0 and np.nanmin(known) > 9.0
    assert not [one for one in data_warnings(data, None) if "loggers" in one.found]
    with pytest.raises(UserError, match="expected no gap where a derivative is asked for"):
        loaded(tmp_path, f"{channel}, derivative = 10.0", 'file = "a.npz"')


@pytest.mark.parametrize("value", ['"65535"', "nan", '["0.5"]', '[""]', "true"])
def test_what_is_neither_a_number_nor_text_is_refused(tmp_path: Path, value: str) -> None:
    written(tmp_path, "a.csv", t=TIME, u=np.cos(TIME), q=ANGLE)
    with pytest.raises(UserError, match="missing"):
        loaded(tmp_path, f'column = "q", unit = "deg", missing = {value}')
