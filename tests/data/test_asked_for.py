"""A column, a file or samples that are not there: the card, the experiment and the channel that ask for them, and what can be done."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.data import load_dataset
from greybox_torch.errors import UserError

Edit = Callable[[Path, str, str], None]
OUT = 'leave the experiment out of the card, or give the channel a column there: columns = { speed = "…" }'
OUT += ", or its value where it has one throughout: constants = { speed = … }"


def told(card: Path) -> str:
    with pytest.raises(UserError) as refused:
        load_dataset(card)
    return str(refused.value)


def test_a_column_that_is_not_there(bench: Path, edit: Edit) -> None:
    card = bench / "dataset.toml"
    edit(card, 'column = "y"', 'column = "Y"')
    said = f'{card}, [[experiment]] "Steps", channel "speed": {bench / "steps.csv"}: no column "Y" (did you mean "y"?); found t, u, y'
    assert told(card) == said, "seen: what to do where only this experiment lacks it, though no file has it"
    (bench / "steps.csv").write_text((bench / "steps.csv").read_text().replace("t,u,y", "t,u,z"))
    edit(card, 'column = "Y"', 'column = "y"')
    assert told(card).endswith(f'no column "y"; found t, u, z; other experiments have it: {OUT}')


def test_the_column_of_the_only_experiment(bench: Path, edit: Edit) -> None:
    card = bench / "dataset.toml"
    card.write_text("".join(card.read_text().partition('[[experiment]]\nname = "Sweep"')[:1]))
    edit(card, 'column = "y"', 'column = "Y"')
    assert told(card).endswith('no column "Y" (did you mean "y"?); found t, u, y')


@pytest.mark.parametrize("join", ["time", "rows"])
def test_a_column_that_none_of_several_files_has(bench: Path, edit: Edit, join: str) -> None:
    """Seen: neither the nearest name nor a list, which a single file has."""
    card = bench / "dataset.toml"
    edit(card, "sample_time = 0.01", 'time = "t"')
    (bench / "wind.csv").write_text("t,wind speed\n" + "".join(f"{0.01 * k:.2f},1\n" for k in range(40)))
    edit(card, 'file = "steps.csv"', f'file = ["steps.csv", "wind.csv"]\njoin = "{join}"')
    edit(card, "speed = {", 'wind = { column = "wind sped" }\nspeed = {')
    there = "it is in none of steps.csv, wind.csv; found t, u, y in steps.csv; t, wind speed in wind.csv"
    assert told(card).endswith(f'no column "wind sped" (did you mean "wind speed"?); {there}')


def test_the_column_of_time_stamps(bench: Path, edit: Edit) -> None:
    card = bench / "dataset.toml"
    edit(card, "sample_time = 0.01", 'time = "tt"')
    assert told(card).startswith(f'{card}, [[experiment]] "Steps", time: {bench / "steps.csv"}: no column "tt"')


def test_a_file_that_is_not_there(bench: Path, edit: Edit) -> None:
    card = bench / "dataset.toml"
    edit(card, 'file = "steps.csv"', 'file = "step.csv"')
    expected = f'{card}, [[experiment]] "Steps": {bench / "step.csv"}: no such file (did you mean "steps.csv"?); expected a recording'
    assert told(card).startswith(expected)


def test_a_channel_that_one_experiment_lacks(bench: Path) -> None:
    card = bench / "dataset.toml"
    np.savez(bench / "sweep.npz", u_val=np.arange(20.0), y=np.full(20, np.nan))
    said = told(card)
    assert said.startswith(f'{card}, [[experiment]] "Sweep", channel "speed": all 20 samples are missing (NaN)')
    assert said.endswith(f"expected numbers; {OUT}")
