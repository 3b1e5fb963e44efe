"""Recordings from tables of any library."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from greybox_torch.data import Recording
from greybox_torch.errors import UserError

N = 20
U, Y = np.arange(float(N)), np.linspace(-1, 1, N)


def tables() -> dict[str, Callable[[dict[str, Any]], Any]]:
    made: dict[str, Callable[[dict[str, Any]], Any]] = {
        "dict": dict,
        "pyarrow": pa.table,
        "batch": lambda columns: pa.RecordBatch.from_pydict({n: pa.array(v) for n, v in columns.items()}),
        "structured": lambda columns: np.rec.fromarrays(list(columns.values()), names=list(columns)),
    }
    for library in ("pandas", "polars"):
        if importlib.util.find_spec(library):
            made[library] = importlib.import_module(library).DataFrame
    return made


@pytest.fixture(params=tables())
def table(request: pytest.FixtureRequest) -> Callable[[dict[str, Any]], Any]:
    return tables()[request.param]


def test_from_tables(table: Callable[[dict[str, Any]], Any]) -> None:
    frame = table({"t": 0.5 * np.arange(N), "voltage": U, "speed": Y})
    found = Recording.from_dataframe("steps", frame, time="t", units={"voltage": "V"})
    assert list(found.signals) == ["voltage", "speed"]
    assert found.sample_time == 0.5
    np.testing.assert_array_equal(found.signals["speed"], Y)
    chosen = Recording.from_dataframe("steps", frame, sample_time=0.1, columns={"w": "speed"})
    assert list(chosen.signals) == ["w"]
    with pytest.raises(
        UserError, match=r"time: frame has no column 'tt' \(did you mean \"t\"\?\); found t, voltage, speed"
    ):
        Recording.from_dataframe("steps", frame, time="tt")
    with pytest.raises(UserError, match=r"columns: frame has no column 'Speed' \(did you mean \"speed\""):
        Recording.from_dataframe("steps", frame, sample_time=1.0, columns={"w": "Speed"})


@pytest.mark.parametrize("frame", [None, 3, U, [U, Y], "text"])
def test_no_table(frame: Any) -> None:
    with pytest.raises(UserError, match=r"frame: found .*, expected a table with columns"):
        Recording.from_dataframe("steps", frame, sample_time=1.0)


def test_pandas_dates_and_missing_integers() -> None:
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame(
        {
            "t": pd.date_range("2026-11-21", periods=N, freq="250ms"),
            "u": pd.array([1, None] * 10, dtype="Int64"),
            "y": U,
        }
    )
    found = Recording.from_dataframe("steps", frame, time="t")
    np.testing.assert_array_equal(found.time, np.arange(N) * 0.25)
    np.testing.assert_array_equal(found.signals["u"], [1, np.nan] * 10)
    with pytest.raises(UserError, match='channel "t": holds datetime64'):
        Recording.from_dataframe("steps", frame, sample_time=1.0)


def test_pandas_dates_with_a_time_zone() -> None:
    """Seen: "found Timestamp(…), expected a number"."""
    pd = pytest.importorskip("pandas")
    stamps = pd.date_range("2026-03-29 01:59:58", periods=N, freq="250ms", tz="Europe/Berlin")  # across summer time
    found = Recording.from_dataframe("steps", pd.DataFrame({"t": stamps, "y": U}), time="t")
    np.testing.assert_allclose(found.time, 0.25 * np.arange(N))


@pytest.mark.parametrize(("name", "column"), [("at", "at"), (None, "index")])
def test_times_in_the_index_are_pointed_at(name: str | None, column: str) -> None:
    pd = pytest.importorskip("pandas")
    stamps = pd.date_range("2026-11-21", periods=N, freq="250ms", name=name)
    frame = pd.DataFrame({"y": U}, index=stamps)
    with pytest.raises(UserError, match=rf"frame.reset_index\(\) makes a column: time='{column}'"):
        Recording.from_dataframe("steps", frame)
    assert Recording.from_dataframe("steps", frame.reset_index(), time=column).sample_time == 0.25


def test_dates_as_text(table: Callable[[dict[str, Any]], Any]) -> None:
    """Seen: the time stamps of pandas.read_csv, text, were refused as no numbers, though a card reads the same file."""
    dates = [f"2025-03-04T10:15:02.{20 * k:03d}" for k in range(N)]
    found = Recording.from_dataframe("steps", table({"t": dates, "speed": Y}), time="t")
    np.testing.assert_allclose(found.time, 0.02 * np.arange(N), rtol=0, atol=1e-12)
    with pytest.raises(
        UserError, match=r"time, sample 3 \(the first is 0\): found 'soon': expected a time stamp like 2026"
    ):
        Recording.from_dataframe("steps", table({"t": [*dates[:3], "soon", *dates[4:]], "speed": Y}), time="t")


def test_a_column_of_text_that_is_no_channel(table: Callable[[dict[str, Any]], Any]) -> None:
    frame = table({"speed": Y, "phase": ["warm"] * N})
    with pytest.raises(
        UserError, match=r'channel "phase".*; every column of the frame is a channel, but where columns = '
    ):
        Recording.from_dataframe("steps", frame, sample_time=1.0)
    found = Recording.from_dataframe("steps", frame, sample_time=1.0, columns={"speed": "speed"})
    assert list(found.signals) == ["speed"]
    with pytest.raises(UserError, match=r"(a number|missing\))$"):
        Recording.from_dataframe("steps", frame, sample_time=1.0, columns={"speed": "phase"})
