"""A sample time that the file's own time stamps contradict is told; counters, other units and rounded stamps are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.data import load_dataset
from greybox_torch.drafting.contradicted_steps import contradicted_steps

CARD = """sample_time = {sample_time}
[channels]
a = {{ column = "a" }}
[[experiment]]
name = "run"
file = "run.csv"
"""


def card(folder: Path, column: str, stamps: np.ndarray, sample_time: float) -> Path:
    rows = [f"{column},a", *(f"{t!r},{0.1 * (k % 7):g}" for k, t in enumerate(stamps.tolist()))]
    (folder / "run.csv").write_text("\n".join(rows) + "\n")
    (folder / "dataset.toml").write_text(CARD.format(sample_time=sample_time))
    return folder / "dataset.toml"


@pytest.mark.parametrize(
    ("column", "step", "sample_time", "write"),
    [
        ("time_s", 10.0, 10000.0, 'time = "time_s" in its place, or sample_time = 10'),
        ("time", 0.01, 10.0, 'time = "time" in its place, or sample_time = 0.01, if the stamps are in s'),
        ("t_ms", 5.0, 5.0, 'time = { column = "t_ms", unit = "ms" } in its place'),
        ("stamp_us", 2000.0, 0.01, 'time = { column = "stamp_us", unit = "us" } in its place'),
        ("Logger ms", 5.0, 5.0, 'time = { column = "Logger ms", unit = "ms" } in its place'),  # the first column
    ],
)
def test_contradicted(tmp_path: Path, column: str, step: float, sample_time: float, write: str) -> None:
    (told,) = data_warnings(load_dataset(card(tmp_path, column, step * np.arange(60), sample_time)), None)
    assert told.found.startswith(f'sample_time: column "{column}" of run.csv has steps of {step:g}')
    assert told.write == write


@pytest.mark.parametrize(
    ("column", "stamps", "sample_time"),
    [
        ("time", 10.0 * np.arange(60), 0.01),  # milliseconds
        ("t_ms", 10.0 * np.arange(60), 0.01),
        ("time", 1.0 * np.arange(60), 0.02),  # counts samples
        ("time_s", np.round(np.arange(60) / 30, 2), 1 / 30),
        ("time", np.sin(np.arange(60)), 0.5),
        ("seq", 10.0 * np.arange(60), 0.5),
        ("force", 10.0 * np.arange(60), 0.5),
    ],
)
def test_nothing_to_tell(tmp_path: Path, column: str, stamps: np.ndarray, sample_time: float) -> None:
    assert list(contradicted_steps(load_dataset(card(tmp_path, column, stamps, sample_time)))) == []


def test_a_channel_that_rises_evenly(tmp_path: Path) -> None:
    path = card(tmp_path, "force", 10.0 * np.arange(60), 0.5)
    path.write_text(
        path.read_text().replace('a = { column = "a" }', 'a = { column = "a" }\nforce = { column = "force" }')
    )
    assert list(contradicted_steps(load_dataset(path))) == []


def test_a_card_that_names_its_time_stamps(tmp_path: Path) -> None:
    path = card(tmp_path, "time_s", 10.0 * np.arange(60), 1.0)
    path.write_text(path.read_text().replace("sample_time = 1.0", 'time = "time_s"'))
    assert list(contradicted_steps(load_dataset(path))) == []


def test_the_unit_that_the_file_says(tmp_path: Path) -> None:
    path = card(tmp_path, "time", 10.0 * np.arange(60), 0.01)
    file = tmp_path / "run.csv"
    file.write_text(file.read_text().replace("time,a\n", "time,a\nms,m\n"))
    assert list(contradicted_steps(load_dataset(path))) == []
    path.write_text(path.read_text().replace("sample_time = 0.01", "sample_time = 10.0"))
    (told,) = contradicted_steps(load_dataset(path))
    assert told.write == 'time = { column = "time", unit = "ms" } in its place'


def test_a_column_of_text_before_the_time_stamps(tmp_path: Path) -> None:
    path = card(tmp_path, "time_s", 10.0 * np.arange(60), 1.0)
    first, *rows = (tmp_path / "run.csv").read_text().splitlines()
    (tmp_path / "run.csv").write_text("\n".join([f"time of day,{first}", *(f"noon,{row}" for row in rows)]))
    (told,) = contradicted_steps(load_dataset(path))
    assert told.column == "time_s"


def test_a_gap_between_experiments_is_none_within_them(tmp_path: Path) -> None:
    """Seen: still told of a card that was divided there."""
    path = card(tmp_path, "time_s", 10.0 * np.delete(np.arange(100), range(40, 60)), 10.0)
    (told,) = contradicted_steps(load_dataset(path))
    assert told.write == (
        'time = "time_s" in its place; or two experiments in place of this one: rows = [0, 40] and rows = [40, 80]'
    )
    whole = path.read_text()
    path.write_text(f'{whole}rows = [0, 40]\n[[experiment]]\nname = "after"\nfile = "run.csv"\nrows = [40, 80]\n')
    assert list(contradicted_steps(load_dataset(path))) == []
    path.write_text(f"{whole}rows = [30, 80]\n")
    (told,) = contradicted_steps(load_dataset(path))
    assert "(after sample 39, the first is 0" in told.found and "rows = [30, 40] and rows = [40, 80]" in told.write
