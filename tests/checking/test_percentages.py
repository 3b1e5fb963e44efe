"""A channel of unit "1" that is a share in percent is told with what to write; ratios, counts and other units are not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.percentages import percentages
from greybox_torch.data import DataSet, Recording, load_dataset


def recorded(values: list[float], unit: str) -> DataSet:
    run = Recording.from_arrays("run", {"throttle": np.tile(values, 10)}, sample_time=0.02, units={"throttle": unit})
    return DataSet([run], held_out_by_default=False)


def test_a_throttle_in_percent() -> None:
    """Seen: a throttle of 4.6 to 100 as "1": its gain went to a hundredth, start fits of -2e7 %, and not a word."""
    data = recorded([4.6, 50.0, np.nan, 100.0], "1")
    (told,) = [str(one) for one in data_warnings(data, None) if "percent" in str(one)]
    assert told.startswith('channel "throttle": has the unit "1" and values from 4.6 to 100, as of a share in percent')
    assert told.endswith("write: values divided by 100 if so")
    (of_card,) = percentages(replace(data, path=Path("dataset.toml")))
    assert of_card.write == 'throttle = { …, file_unit = "%" } if so, or scale = 1.0 in its line if it is none'


def test_a_scale_on_the_card_says_that_it_is_none(tmp_path: Path) -> None:
    """Seen: nothing silenced it, and the file_unit that was advised is refused beside a scale."""
    (tmp_path / "run.csv").write_text("\n".join(["n", *(str(k) for k in range(100))]))
    card = tmp_path / "dataset.toml"
    for scale, told in (("", 1), (", scale = 1.0", 0)):
        line = f'"a b" = {{ column = "n", unit = "1"{scale} }}'
        card.write_text(f'sample_time = 0.1\n[channels]\n{line}\n[[experiment]]\nname = "a"\nfile = "run.csv"\n')
        found = [*percentages(load_dataset(card))]
        assert len(found) == told and all(one.write.startswith('"a b" = {') for one in found)


@pytest.mark.parametrize(
    ("values", "unit"),
    [
        ([0.0, 1.0], "1"),
        ([0.0, 8.0], "1"),
        ([0.0, 4095.0], "1"),
        ([-2000.0, 80.0], "1"),
        ([0.0, 100.0], "%"),
        ([0.0, 100.0], ""),
    ],
)
def test_nothing_is_told(values: list[float], unit: str) -> None:
    assert not [*percentages(recorded(values, unit))]


def test_a_fraction_that_is_called_percent(tmp_path: Path) -> None:
    data = recorded([0.03, 0.4, np.nan, 0.7], "%")
    (told,) = percentages(data)
    assert 'unit "%" and values from 0.03 to 0.7, as of a fraction of 1' in told.found
    assert told.write == "values multiplied by 100 if so"
    (tmp_path / "run.csv").write_text("\n".join(["n", *(str(0.01 * k) for k in range(100))]))
    card = tmp_path / "dataset.toml"
    for more, told in (("", 1), (", scale = 1.0", 0), (', file_unit = "1"', 0)):
        line = f'n = {{ column = "n", unit = "%"{more} }}'
        card.write_text(f'sample_time = 0.1\n[channels]\n{line}\n[[experiment]]\nname = "a"\nfile = "run.csv"\n')
        found = [*percentages(load_dataset(card))]
        assert len(found) == told and all('file_unit = "1" } if so' in one.write for one in found)
