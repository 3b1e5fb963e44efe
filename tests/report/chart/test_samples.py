from __future__ import annotations

import json
from base64 import b64decode
from typing import Any

import numpy as np
import pytest

from greybox_torch.report.chart.samples import MOST_VALUES, Samples, share_of_each


def unpacked(packed: dict[str, Any]) -> np.ndarray:
    steps = np.frombuffer(b64decode(packed["data"]), "<u2").astype(float)
    return np.where(steps == 65535, np.nan, packed["low"] + packed["reach"] * steps / 65534)


def told(time: np.ndarray, most: int = 1000, **series: np.ndarray) -> dict[str, Any]:
    return json.loads(Samples(3, time, series).text(most))


def test_a_short_record_is_carried_sample_by_sample() -> None:
    time, values = 0.5 + 0.01 * np.arange(500), np.sin(np.arange(500.0))
    values[20:30], values[40] = np.nan, np.inf
    found = told(time, speed=values)
    assert (found["experiment"], found["paired"], found["time"]) == (3, False, [0.5, pytest.approx(5.49)])
    assert found["step"] == pytest.approx(0.01) and "clock" not in found
    back = unpacked(found["series"]["speed"])
    assert np.isnan(back[20:30]).all() and np.isnan(back[40])
    known = np.isfinite(values)
    assert back[known] == pytest.approx(values[known], abs=2.0 / 65534)


def test_a_long_record_keeps_its_extremes() -> None:
    time, values = 0.001 * np.arange(100_003), np.random.default_rng(0).normal(size=100_003)
    values[77_777], values[50_000:51_000] = 40.0, np.nan
    found = told(time, 1000, speed=values)
    back = unpacked(found["series"]["speed"]).reshape(-1, 2)
    size = round(found["step"] / 0.001)
    assert found["paired"] and len(back) <= 500 and size == 201
    assert back[77_777 // size, 1] == pytest.approx(40.0, abs=1e-3)
    assert np.isnan(back[50_000 // size + 1 : 51_000 // size - 1]).all()
    part = values[201 * 10 : 201 * 11]
    assert back[10] == pytest.approx([part.min(), part.max()], abs=1e-3)


def test_time_stamps_that_are_not_even() -> None:
    time = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 300))
    found = told(time, speed=time)
    assert "step" not in found
    assert unpacked(found["clock"]) == pytest.approx(time, abs=1e-2)


@pytest.mark.parametrize(
    "values", [np.full(5, np.nan), np.zeros(5), np.full(5, 1e300), np.array([-1e308, 1e308, 0, 0, 0])]
)
def test_series_without_extent(values: np.ndarray) -> None:
    back = unpacked(told(np.arange(5.0), speed=values)["series"]["speed"])
    assert np.isnan(back).all() if np.isnan(values).all() else back.shape == (5,)


def test_no_name_ends_the_element() -> None:
    assert "<" not in Samples(0, np.arange(3.0), {"</script>": np.arange(3.0)}).text(10)


def test_all_charts_share_what_a_page_carries() -> None:
    assert 12 * 5 * share_of_each(12, 5) <= MOST_VALUES < 13 * 5 * share_of_each(12, 5) + 65
