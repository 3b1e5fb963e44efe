"""A slower channel among the rows of a faster one is no channel with most samples missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.checking.lone_samples import lone_samples
from greybox_torch.checking.missing_inputs import missing_inputs
from greybox_torch.data import load_dataset
from greybox_torch.data.slower_columns import slower_column
from greybox_torch.report.channels import plot_channels
from greybox_torch.systems import load_model

N, EVERY = 200, 10
TIME = 0.02 * np.arange(N)
NAN = np.nan


def every(values: np.ndarray, step: int = EVERY) -> np.ndarray:
    """The values (N,), known in every ``step``-th row alone."""
    return np.where(np.arange(len(values)) % step == 0, values, NAN)


def test_straight_lines_between_samples() -> None:
    wave = np.sin(3.0 * TIME)
    found = slower_column("wind", TIME, every(wave))
    assert found is not None and found.note == "wind has a sample every 0.2 s alone: on straight lines between them"
    assert found.values[:191] == pytest.approx(np.interp(TIME[:191], TIME[::EVERY], wave[::EVERY]))
    assert np.isnan(found.values[191:]).all() and not found.between[::EVERY].any() and found.between.sum() == 171


def test_a_set_point_is_held() -> None:
    steps = np.repeat([0.0, 2.0, -1.0, 5.0], N // 4)
    found = slower_column("set", TIME, every(steps))
    assert found is not None and found.note.endswith("held from one to the next, as it rarely changes")
    assert found.values.tolist() == steps.tolist()


def test_where_it_has_a_gap_it_is_missing() -> None:
    values = every(np.sin(TIME))
    values[40:150] = NAN
    found = slower_column("wind", TIME, values)
    assert found is not None and np.isnan(found.values[31:150]).all() and not found.between[31:150].any()
    assert not np.isnan(found.values[:31]).any()


@pytest.mark.parametrize("kind", ["whole", "few", "random", "burst", "three"])
def test_what_is_no_slower_channel(kind: str) -> None:
    values = np.sin(TIME)
    lost = {
        "whole": np.zeros(N, bool),
        "few": np.arange(N) % 10 == 3,
        "random": np.random.default_rng(0).random(N) < 0.8,
        "burst": np.arange(N) > 20,
        "three": ~np.isin(np.arange(N), (0, 90, 180)),
    }[kind]
    assert slower_column("w", TIME, np.where(lost, NAN, values)) is None


def card(tmp_path: Path, wind: np.ndarray) -> Path:
    rows = [
        f"{t:.2f},{k % 7},{'' if np.isnan(w) else f'{w:.4f}'},{np.sin(t):.4f}"
        for k, (t, w) in enumerate(zip(TIME, wind, strict=True))
    ]
    (tmp_path / "a.csv").write_text("t,u,w,y\n" + "\n".join(rows) + "\n")
    (tmp_path / "dataset.toml").write_text(
        'time = "t"\n[channels]\nu = { column = "u" }\nw = { column = "w" }\ny = { column = "y" }\n'
        '[[experiment]]\nname = "a"\nfile = "a.csv"\n'
    )
    return tmp_path / "dataset.toml"


def test_a_file_with_one(tmp_path: Path) -> None:
    (run, *_) = load_dataset(card(tmp_path, every(np.cos(3.0 * TIME)))).recordings
    assert not np.isnan(run.signals["w"]).any() and np.isnan(run.measured("w")).sum() == 135
    assert run.notes[-1] == "slower than the rest, an output among them counts at its own samples alone: w"


def test_an_error_value_is_told_once_where_it_stands(tmp_path: Path) -> None:
    wind = every(np.cos(3.0 * TIME))
    wind[50] = 900.0
    (told,) = [one for one in lone_samples(load_dataset(card(tmp_path, wind)), {}) if one.channel == "w"]
    assert told.value == 900.0 and "line 52" in told.place


def test_samples_that_stand_alone_are_drawn(tmp_path: Path) -> None:
    """Seen: an empty panel."""
    wind = np.full(N, NAN)
    wind[[0, 30, 31, 95, 170]] = 1.0, 2.0, 3.0, 4.0, 5.0
    file = card(tmp_path, wind)
    file.write_text(file.read_text() + 'role = "validation"\n')
    panel = plot_channels(load_dataset(file)).axes[1]
    (dots,) = [line for line in panel.get_lines() if line.get_marker() == "."]
    assert np.asarray(dots.get_ydata()).tolist() == [1.0, 4.0, 5.0]


def test_no_warning_of_missing_samples(motor_folder) -> None:
    folder = motor_folder()
    columns, *rows = (line.split(",") for line in (folder / "steps.csv").read_text().splitlines())
    for k, row in enumerate(rows):
        row[columns.index("v")] = row[columns.index("v")] if k % 10 == 0 or k == len(rows) - 1 else ""
    (folder / "steps.csv").write_text("\n".join(",".join(row) for row in (columns, *rows)))
    data = load_dataset(folder / "dataset.toml")
    assert data.model is not None and list(missing_inputs(data, load_model(data.model))) == []
