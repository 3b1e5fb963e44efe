from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from greybox_torch.data import DataSet, Recording, load_dataset
from greybox_torch.report.channels import plot_channels


def test_every_channel_of_every_experiment(bench: Path) -> None:
    figure = plot_channels(load_dataset(bench / "dataset.toml"))
    assert figure.get_suptitle() == "Bench motor"
    axes = figure.axes
    assert [a.get_title() for a in axes] == ["Steps (estimation)", "", "Sweep (validation)", ""]
    assert [a.get_ylabel() for a in axes] == ["voltage [V]", "speed [rad/s]", "", ""]
    assert [a.get_xlabel() for a in axes] == ["", "time [s]", "", "time [s]"]
    assert axes[0].get_xlim() == axes[1].get_xlim() == (0.0, 0.39)
    assert axes[0].get_ylim() == axes[2].get_ylim()
    speed = axes[1].lines[0].get_ydata()
    assert np.isnan(speed[7])
    assert [text.get_text() for text in axes[1].texts] == ["1 missing"]
    assert axes[1].lines[1].get_xdata() == [0.07]


def test_more_experiments_than_columns(bench: Path, edit: Callable[[Path, str, str], None]) -> None:
    card = bench / "dataset.toml"
    extra = "".join(f'[[experiment]]\nname = "Extra {k}"\nfile = "steps.csv"\n' for k in range(3))
    edit(card, "[model.parameters]", extra + "[model.parameters]")
    figure = plot_channels(load_dataset(card))
    assert len(figure.axes) == 2 * 5
    columns = {round(axes.get_position().x0, 3) for axes in figure.axes}
    assert len(columns) == 3


def test_very_many_of_both_are_told_and_not_drawn() -> None:
    run = {f"c{k}": np.arange(12.0) for k in range(60)}
    data = DataSet(
        [Recording.from_arrays(f"run {k}", run, sample_time=0.1, role="validation") for k in range(40)], name="Many"
    )
    figure = plot_channels(data)
    assert len(figure.axes) == 72
    assert figure.get_suptitle() == "Many (the first 24 of 60 channels) (the first 3 of 40 experiments)"
