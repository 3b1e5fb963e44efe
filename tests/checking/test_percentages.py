"""A channel of unit "1" that is a share in percent is told with what to write; ratios, counts and other units are not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.percentages import percentages
from greybox_torch.data import DataSet, Recording


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
    assert of_card.write == 'throttle = { …, file_unit = "%" } if so'


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
