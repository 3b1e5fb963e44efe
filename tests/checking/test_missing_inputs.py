"""Stretches in which an input is missing are told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from greybox_torch.api.check import check
from greybox_torch.checking.missing_inputs import LONGEST, MissingInput, missing_inputs
from greybox_torch.cli import app
from greybox_torch.data import load_dataset
from greybox_torch.systems import load_model

PIECES = "two experiments in place of this one: rows = [0, 60] and rows = [95, 600]"


@pytest.fixture
def card(motor_folder: Callable[..., Path]):
    """The card of a motor of which one experiment lacks stretches of samples of its voltage (v), or of its speed (w)."""

    def make(**gone: list[slice]) -> Path:
        folder = motor_folder()
        columns, *rows = (line.split(",") for line in (folder / "steps.csv").read_text().splitlines())
        for name, stretches in gone.items():
            for row in (row for stretch in stretches for row in rows[stretch]):
                row[columns.index(name)] = ""
        (folder / "steps.csv").write_text("\n".join(",".join(row) for row in (columns, *rows)))
        return folder / "dataset.toml"

    return make


def gaps(card: Path) -> list[MissingInput]:
    data = load_dataset(card)
    assert data.model is not None
    return list(missing_inputs(data, load_model(data.model)))


def test_the_longest_stretch_of_an_input_is_told(card) -> None:
    (gap,) = gaps(card(v=[slice(20, 23), slice(60, 95)], w=[slice(0, 50)]))
    assert (gap.experiment, gap.channel, gap.first, gap.count, gap.missing) == ("Steps", "voltage", 60, 35, 38)
    assert gap.seconds == pytest.approx(0.35)
    assert "38 of 600 samples of this input are missing, 35 of them (0.35 s) from sample 60 on" in gap.found


def test_what_to_write_at_either_end(card) -> None:
    """Seen: an experiment "that begins after it", of the last nine samples."""
    path = card(v=[slice(0, 9), slice(592, 600)])
    (gap,) = gaps(path)
    assert gap.write == "rows = [9, 600]" and "the first value after stands for them" in gap.found
    path.write_text(path.read_text().replace('name = "Steps"', 'name = "Steps"\nrows = [300, 600]', 1))
    (gap,) = gaps(path)
    assert (gap.count, gap.write) == (8, "rows = [300, 592]"), "seen: one that begins after the last samples"


def test_a_few_lost_samples_and_those_of_outputs_are_nothing(card) -> None:
    few = [slice(k, k + LONGEST) for k in (0, 40, 595)]
    assert gaps(card(v=few, w=[slice(60, 120)])) == []


def test_check_and_fit_warn(card) -> None:
    path = card(v=[slice(60, 95)])
    data = load_dataset(path)
    assert data.model is not None
    (finding,) = [f for f in check(data.model, data).findings if "samples of this input" in f.found]
    assert finding.level == "warning" and finding.file == path and finding.write == PIECES
    told = CliRunner().invoke(app, ["simulate", str(path), "--out", str(path.parent / "out")])
    assert told.exit_code == 0, told.output
    assert (
        "warning: " in told.stderr and 'channel "voltage": 35 of 600 samples of this input are missing' in told.stderr
    )
