"""Recordings from what is in memory: what goes in comes out, and what cannot be right is refused with the argument's name."""

from __future__ import annotations

import copy
import doctest
import pickle
from datetime import UTC, datetime, timedelta, tzinfo
from typing import Any
from zoneinfo import ZoneInfo

import numpy as np
import pyarrow as pa
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from greybox_torch.data import DataSet, Recording, dataset, recording
from greybox_torch.errors import UserError

N = 20
U, Y = np.arange(float(N)), np.linspace(-1, 1, N)
STAMPS = np.ma.masked_array(np.datetime64("2026-11-21T08:00:00") + np.arange(N) * np.timedelta64(2, "s"), mask=U == 12)


def made(**changes: Any) -> Recording:
    given = {"signals": {"u": U, "y": Y}, "sample_time": 0.01} | changes
    return Recording.from_arrays(given.pop("name", "run"), given.pop("signals"), **given)


def test_from_arrays() -> None:
    found = made(units={"u": "V"}, role="validation")
    assert (found.name, found.role, found.sample_time, found.rows, found.source) == (
        "run",
        "validation",
        0.01,
        (0, N),
        None,
    )
    np.testing.assert_array_equal(found.time, np.arange(N) * 0.01)
    np.testing.assert_array_equal(found.signals["y"], Y)
    assert found.units == {"u": "V"}
    assert found.seconds == pytest.approx(0.01 * N)
    assert repr(found) == "Recording('run', validation: 20 samples of u [V], y, 0.01 s apart)"


@given(
    arrays(np.float64, st.integers(10, 40), elements=st.just(np.nan) | st.floats(-1e100, 1e100)),
    st.floats(1e-6, 1e3),
    st.sampled_from([np.float64, np.float32, object, list]),
)
def test_what_goes_in_comes_out(values: np.ndarray, sample_time: float, kind: Any) -> None:
    values[0] = 1.0
    with np.errstate(over="ignore"):
        values = values.astype(np.float32).astype(float) if kind is np.float32 else values
    values[np.isinf(values)] = 0.0
    given_as = list(values) if kind is list else values.astype(kind)
    found = Recording.from_arrays("run", {"u": given_as}, sample_time=sample_time)
    np.testing.assert_array_equal(found.signals["u"], values)
    stamped = Recording.from_arrays("run", {"u": given_as}, time=found.time)
    np.testing.assert_array_equal(stamped.time, found.time)
    assert stamped.sample_time == np.median(np.diff(found.time))


@pytest.mark.parametrize(
    "values",
    [
        torch.arange(float(N), requires_grad=True),
        list(range(N)),
        np.arange(N, dtype=np.uint8),
        pa.array(range(N)),
        pa.chunked_array([list(range(7)), list(range(7, N))]),
        np.arange(2.0 * N)[::2] / 2,
    ],
)
def test_sequences_of_other_libraries(values: Any) -> None:
    np.testing.assert_array_equal(made(signals={"u": values}).signals["u"], U)


@pytest.mark.parametrize(
    "values",
    [
        [1.0, None, *[3.0] * 10],
        np.ma.masked_array([1.0, 7.0, *[3.0] * 10], mask=[0, 1, *[0] * 10]),
        np.ma.masked_array([1.0, "?", *[3.0] * 10], mask=[0, 1, *[0] * 10], dtype=object),
        pa.array([1, None, *[3] * 10]),
        [1.0, float("nan"), *[3.0] * 10],
    ],
)
def test_missing_samples_are_nan(values: Any) -> None:
    np.testing.assert_array_equal(made(signals={"u": values}).signals["u"], [1, np.nan, *[3] * 10])


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_dates_and_times_count_from_the_first(unit: str) -> None:
    stamps = np.datetime64("2026-11-21T08:00:00", unit) + np.arange(N) * np.timedelta64(2, "s")
    np.testing.assert_array_equal(made(sample_time=None, time=stamps).time, np.arange(N) * 2.0)
    np.testing.assert_array_equal(made(sample_time=None, time=stamps - stamps[0]).time, np.arange(N) * 2.0)


@pytest.mark.parametrize("unit", ["M", "Y"])
def test_dates_of_months_and_years_count_from_the_first_day(unit: str) -> None:
    stamps = np.arange(N).astype(f"datetime64[{unit}]")
    days = [(at.astype("datetime64[D]") - np.datetime64("1970-01-01")).astype(float) for at in stamps]
    np.testing.assert_array_equal(made(sample_time=None, time=stamps).time, np.array(days) * 86400.0)
    stamps[12] = "NaT"
    with pytest.raises(UserError, match=r"time, sample 12 \(the first is 0\): the time stamp is missing"):
        made(sample_time=None, time=stamps)
    with pytest.raises(UserError, match=rf'"run", time: holds timedelta64\[{unit}\]; expected seconds, or timedelta64'):
        made(sample_time=None, time=np.arange(N).astype(f"timedelta64[{unit}]"))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"signals": {"u": np.ma.masked_array(["a"] * N)}}, 'channel "u": holds text; expected real numbers'),
        ({"signals": {"u": np.ma.masked_array([1 + 2j] * N)}}, 'channel "u": holds complex numbers'),
        ({"sample_time": None, "time": STAMPS}, "time, sample 12 (the first is 0): the time stamp is missing"),
        ({"sample_time": None, "time": STAMPS - STAMPS[0]}, "sample 12 (the first is 0): the time stamp is missing"),
    ],
)
def test_masked_arrays_of_other_kinds(changes: dict[str, Any], message: str) -> None:
    """Seen: a raw ValueError, a recording without the imaginary parts, and "found 0 s after 22 s" of a time that is masked."""
    with pytest.raises(UserError) as error:
        made(**changes)
    assert message in str(error.value)


def test_times_of_a_zone_pass_to_summer_time() -> None:
    begins = datetime(2026, 3, 29, 1, 59, 50, tzinfo=ZoneInfo("Europe/Berlin"))
    stamps = [(begins.astimezone(UTC) + k * timedelta(seconds=1)).astimezone(begins.tzinfo) for k in range(N)]
    np.testing.assert_array_equal(made(sample_time=None, time=stamps).time, np.arange(N) * 1.0)


@pytest.mark.parametrize("first", [None, UTC])
def test_times_with_and_without_a_zone(first: tzinfo | None) -> None:
    stamps = [datetime(2026, 3, 29, 1, 0, k, tzinfo=UTC if (k == 5) == (first is None) else None) for k in range(N)]
    with pytest.raises(UserError, match=r"time, sample 5 .* found 2026-03-29 01:00:05.* with.* a time zone"):
        made(sample_time=None, time=stamps)


LONGER = np.arange(N + 1.0)


def with_entry(values: np.ndarray, index: int, value: float) -> np.ndarray:
    copy = values.copy()
    copy[index] = value
    return copy


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": ""}, "Recording, name: found '', expected text"),
        ({"name": 3}, "Recording, name: found 3"),
        ({"role": "test"}, 'recording "run", role: found \'test\', expected "estimation" or "validation"'),
        ({"sample_time": None}, 'recording "run": sample_time is missing; expected sample_time (seconds), or time'),
        ({"time": U}, "both sample_time and time are given"),
        ({"sample_time": 0.0}, "sample_time: found 0.0, expected a number above zero, in seconds"),
        ({"sample_time": -1}, "sample_time: found -1"),
        ({"sample_time": float("nan")}, "sample_time: found nan"),
        ({"sample_time": float("inf")}, "sample_time: found inf"),
        ({"sample_time": "10 ms"}, "sample_time: found '10 ms'"),
        ({"sample_time": True}, "sample_time: found True"),
        ({"signals": {}}, "signals: found {}, expected arrays by channel"),
        ({"signals": U}, "signals: found an object of type ndarray, expected arrays by channel"),
        ({"signals": {"time": U}}, '"time" cannot name a channel; time stamps are the argument time'),
        ({"signals": {3: U}}, "found a channel named 3"),
        ({"signals": {"u": U, "y": LONGER}}, 'arrays differ in length: "u" has 20, "y" has 21'),
        ({"time": LONGER, "sample_time": None}, 'arrays differ in length: "u" has 20, "y" has 20, "time" has 21'),
        ({"signals": {"u": U[:9]}}, 'recording "run": has 9 samples; expected at least 10'),
        ({"signals": {"u": []}}, "has 0 samples"),
        ({"signals": {"u": U * np.nan}}, 'channel "u": all 20 samples are missing (NaN); expected numbers'),
        (
            {"signals": {"u": with_entry(U, 3, np.inf)}},
            'channel "u", sample 3 (the first is 0): found inf, expected a finite',
        ),
        ({"signals": {"u": U.reshape(4, 5)}}, 'channel "u": has the shape (4, 5); expected (N,), one number a sample'),
        ({"signals": {"u": 3.0}}, "signals: found one number for every channel, expected an array of one at least"),
        ({"signals": {"u": U * 1j}}, 'channel "u": holds complex numbers; expected real numbers'),
        ({"signals": {"u": ["1"] * N}}, 'channel "u": holds text; expected real numbers'),
        ({"signals": {"u": [1.0, "2", None] * 5}}, "sample 1 (the first is 0): found '2', expected a number"),
        ({"signals": {"u": np.array([1.0, "2", None] * 5, dtype=object)}}, "sample 1 (the first is 0): found '2'"),
        ({"signals": {"u": np.array([10**400] * N, dtype=object)}}, 'channel "u", sample 0'),
        ({"signals": {"u": [[1.0], [1.0, 2.0]]}}, 'channel "u": cannot be made an array'),
        ({"signals": {"u": np.array(["2026-01-01"] * N, dtype="datetime64[s]")}}, "holds datetime64[s]"),
        (
            {"time": with_entry(U, 4, np.nan), "sample_time": None},
            "time, sample 4 (the first is 0): the time stamp is missing",
        ),
        ({"time": with_entry(U, 4, np.inf), "sample_time": None}, "time, sample 4 (the first is 0): found inf"),
        (
            {"time": with_entry(U, 4, 3.0), "sample_time": None},
            "sample 4 (the first is 0): found 3 s after 3 s; expected time stamps",
        ),
        ({"units": {"v": "V"}}, "units: no channel 'v'; expected u, y"),
        ({"units": {"u": 1}}, 'units: found 1 for "u", expected text such as'),
    ],
)
def test_what_can_be_wrong(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError) as error:
        made(**changes)
    assert message in str(error.value)


def test_no_later_change_reaches_the_recording() -> None:
    u, stamps, signals = U.copy(), np.arange(N) * 0.1, {}
    signals["u"] = u
    found = made(signals=signals, sample_time=None, time=stamps)
    part = found.part(2, 15)
    u[:], stamps[:] = 99.0, 99.0
    del signals["u"]
    np.testing.assert_array_equal(found.signals["u"], U)
    np.testing.assert_array_equal(part.time, np.arange(N)[2:15] * 0.1)
    for array in (found.time, found.signals["u"], part.time, part.signals["u"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    assert part.signals["u"].base is not None, "a part is a view, not a copy"


def test_read_only_view_of_an_array_that_can_be_written_is_copied() -> None:
    u = U.copy()
    view = u[:]
    view.setflags(write=False)
    found = Recording("run", "estimation", np.arange(N) * 0.1, 0.1, {"u": view})
    u[:] = 99.0
    np.testing.assert_array_equal(found.signals["u"], U)


def test_copies_and_pickles() -> None:
    found = made()
    for twin in (copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        np.testing.assert_array_equal(twin.signals["u"], U)


def test_examples_in_the_documentation_run() -> None:
    for module in (recording, dataset):
        names = {"Recording": Recording, "DataSet": DataSet}
        failed, tried = doctest.testmod(module, extraglobs=names)
        assert (failed, tried > 0) == (0, True)


def test_backward_stamps_since_1970_are_told_apart() -> None:
    time = 1.7726148e9 + np.array([*range(11), 4.5])
    with pytest.raises(UserError, match=r"found 1772614804\.5 s after 1772614810 s"):
        Recording.from_arrays("run", {"u": np.ones(12)}, time=time)
