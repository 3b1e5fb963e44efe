from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
from matplotlib.figure import Figure

from greybox_torch.data import Channel, DataSet, Recording, load_dataset
from greybox_torch.estimate.residuals import Correlation, Residuals
from greybox_torch.report.channels import plot_channels
from greybox_torch.report.comparison import plot_comparison
from greybox_torch.report.residuals import _plot_errors, plot_residuals


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
    assert axes[1].texts[0].get_position()[0] > 1.0, "seen: on the curve"
    assert axes[1].lines[1].get_xdata() == [0.07]


def test_no_line_is_drawn_across_a_gap(bench: Path) -> None:
    """Seen: 0.3 s without a sample as a straight line, as if it had been measured."""
    data = load_dataset(bench / "dataset.toml")
    late = np.where(np.arange(len(data.recordings[0])) < 20, 0.0, 0.3)
    torn = replace(data.recordings[0], time=data.recordings[0].time + late)
    figure = plot_channels(DataSet([torn], channels=data.channels, held_out_by_default=False))
    voltage = np.asarray(figure.axes[0].lines[0].get_ydata())
    assert np.flatnonzero(np.isnan(voltage)).tolist() == [20] and len(voltage) == len(torn) + 1


def test_residuals_label_a_column_once() -> None:
    """Seen: 36 panels of 2568 dots in height, every one with a title and a label of its own."""
    found = Correlation(np.arange(3), np.zeros(3), 0.1)
    run = Recording.from_arrays("run", {"speed": np.zeros(12)}, sample_time=0.1)
    row = SimpleNamespace(
        recording=run, output=Channel("speed", "rad/s"), errors=np.zeros(12), whiteness=found, inputs={"u": found}
    )
    figure = plot_residuals(cast(list[Residuals], [row] * 9), "title")
    titles = [axes.get_title() for axes in figure.axes]
    assert titles.count("autocorrelation") == 1 and titles.count("run (estimation)") == 9
    assert [axes.get_xlabel() for axes in figure.axes].count("lag [samples]") == 2 and figure.get_figheight() < 16.0


def test_residuals_between_missing_ones_are_dots() -> None:
    """Seen: an empty panel for a sensor that is slower than the rest."""
    found = Correlation(np.arange(3), np.zeros(3), 0.1)
    run = Recording.from_arrays("run", {"speed": np.zeros(12)}, sample_time=0.1)
    errors = np.where(np.arange(12) % 3 == 0, 1.0, np.nan)
    row = SimpleNamespace(
        recording=run, output=Channel("speed", "rad/s"), errors=errors, whiteness=found, inputs={"u": found}
    )
    dots = plot_residuals(cast(list[Residuals], [row]), "title").axes[0].lines[1]
    assert dots.get_marker() == "." and np.asarray(dots.get_ydata()).tolist() == [1.0] * 4


def test_time_axes_begin_at_0(bench: Path) -> None:
    """Stamps may be dates, of which seconds since 1970 nobody can read from an axis."""
    data = load_dataset(bench / "dataset.toml")
    late = DataSet(
        [replace(one, time=one.time + 1.7726e9) for one in data.recordings],
        channels=data.channels,
        held_out_by_default=False,
    )
    run = late.recordings[0]
    simulated = {"start": np.zeros((len(run), 1))}
    tested = SimpleNamespace(recording=run, output=data.channels["speed"], errors=np.zeros(len(run)))
    axes = Figure().add_subplot()
    _plot_errors(axes, cast(Residuals, tested))
    figures = [plot_channels(late), plot_comparison(run, [data.channels["speed"]], simulated, {"start": "start"})]
    for first in (figures[0].axes[0], figures[1].axes[0], axes):
        np.testing.assert_allclose(np.asarray(first.lines[0].get_xdata())[[0, -1]], [0.0, 0.39], atol=1e-6)


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


def test_long_records_have_hours_or_days() -> None:
    """Seen: 0.5×10⁵ s on the axis of a building's week."""
    for step, label, end in ((300.0, "time [h]", 99 * 300.0 / 3600.0), (3600.0, "time [d]", 99.0 / 24.0)):
        signals = {"heat": np.ones(100), "air": np.arange(100.0)}
        data = DataSet([Recording.from_arrays("zone", signals, sample_time=step)], held_out_by_default=False)
        axes = plot_channels(data).axes
        assert axes[-1].get_xlabel() == label and axes[-1].get_xlim()[1] == end
        outputs = [data.channels["air"]]
        figure = plot_comparison(data.recordings[0], outputs, {"model": np.zeros((100, 1))}, {"model": "m"})
        assert [a.get_xlabel() for a in figure.axes] == ["", label, "", label]
