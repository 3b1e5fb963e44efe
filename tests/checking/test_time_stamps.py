"""Gaps in time stamps, and files in different units of time, are told with what to write instead."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from greybox_torch.api.check import check
from greybox_torch.api.inspect import inspect
from greybox_torch.checking.time_stamps import OddTime, odd_time_stamps
from greybox_torch.cli import app
from greybox_torch.data import DataSet, Recording, load_dataset
from greybox_torch.data.gaps import longest_gap, lost_samples, without_gaps
from greybox_torch.data.steps import unevenness

EVEN: np.ndarray = np.arange(400) * 0.01


def recorded(name: str, time: np.ndarray) -> Recording:
    return Recording.from_arrays(name, {"voltage": np.sin(time), "speed": np.cos(time)}, time=time)


def test_the_longest_gap_is_told_with_place_and_length() -> None:
    time: np.ndarray = np.delete(EVEN, [*range(100, 110), *range(200, 240)])
    gap = longest_gap(time)
    assert gap is not None and (gap.after, gap.count) == (189, 2)
    assert str(gap) == (
        "gap in the time stamps: no sample for 0.41 s, from 1.99 to 2.4 s after the start (after sample 189, the first is 0; "
        "usual step 0.01 s), "
        "the longest of 2 gaps"
    )
    np.testing.assert_allclose(without_gaps(time), 0.01)


@pytest.mark.parametrize(
    "time",
    [
        EVEN,
        np.delete(EVEN, range(100, 105)),  # a few lost samples
        np.cumsum(np.tile([0.01] * 9 + [0.2], 40)),  # written whenever something changes
    ],
)
def test_no_gap(time: np.ndarray) -> None:
    assert longest_gap(time) is None and len(without_gaps(time)) == len(time) - 1


def test_rows_before_and_after_the_gap() -> None:
    time = np.delete(EVEN, range(100, 140))
    both = [recorded("Steps", time), replace(recorded("Again", EVEN), role="validation")]
    for odd in (
        *odd_time_stamps(DataSet(both), {}),
        *odd_time_stamps(DataSet(both[:1]), {}),
    ):  # the latter holds out its last quarter
        _before_and_after(odd)
    (late,) = odd_time_stamps(DataSet([recorded("Steps", np.delete(EVEN, range(330, 370)))]), {})
    assert "rows = [0, 330] and rows = [330, 360]" in late.write


def _before_and_after(odd: OddTime) -> None:
    assert odd.found.startswith('[[experiment]] "Steps": gap in the time stamps: no sample for 0.41 s')
    assert "rows = [0, 100] and rows = [100, 360]" in odd.write


def test_seconds_beside_milliseconds() -> None:
    (odd,) = odd_time_stamps(DataSet([recorded("Steps", EVEN), recorded("Sweep", 1000.0 * EVEN)]), {})
    assert '"Sweep": its sample time is 10 s, 1000 times that of "Steps" (0.01 s)' in odd.found
    assert list(odd_time_stamps(DataSet([recorded("Steps", EVEN), recorded("Sweep", 100.0 * EVEN)]), {})) == []


def test_check_inspect_and_simulate_warn(motor_folder: Callable[..., Path]) -> None:
    folder = motor_folder()
    path, steps = folder / "dataset.toml", folder / "steps.csv"
    names, *rows = steps.read_text().splitlines()
    stamped = [f"t,{names}", *(f"{0.01 * k:.2f},{row}" for k, row in enumerate(rows) if not 100 <= k < 140)]
    steps.write_text("\n".join(stamped))
    for other in folder.glob("*.csv"):
        if other != steps:
            names, *rows = other.read_text().splitlines()
            other.write_text("\n".join([f"t,{names}", *(f"{0.01 * k:.2f},{row}" for k, row in enumerate(rows))]))
    lines = path.read_text().splitlines()
    path.write_text("\n".join('time = "t"' if line.startswith("sample_time") else line for line in lines))
    data = load_dataset(path)
    assert data.model is not None
    (finding,) = [one for one in check(data.model, data).findings if "gap in the time stamps" in one.found]
    assert finding.level == "warning" and "rows = [0, 100] and rows = [100, " in finding.write
    assert any("no sample for 0.41 s" in str(one) for one in inspect(data).warnings)
    told = CliRunner().invoke(app, ["simulate", str(path), "--out", str(folder / "out")])
    assert told.exit_code == 0, told.output
    assert "warning: " in told.stderr and "gap in the time stamps: no sample for 0.41 s" in told.stderr


def test_a_gap_between_dates_is_told_in_seconds_from_the_start() -> None:
    (odd,) = odd_time_stamps(DataSet([recorded("Steps", 1.7726e9 + np.delete(10.0 * EVEN, range(100, 140)))]), {})
    assert "no sample for 4.1 s, from 9.9 to 14 s after the start" in odd.found


def test_lost_samples_are_told_with_places_and_what_to_write() -> None:
    """Seen: six samples in three places were most of a free run's error under feedback, and only "uneven" was said."""
    time = np.delete(
        EVEN + 1e-4 * np.random.default_rng(0).normal(size=400), [100, 150, 151, 152, *range(200, 205), 300]
    )
    (odd,) = odd_time_stamps(DataSet([recorded("Steps", time)], held_out_by_default=False), {})
    assert '"Steps": 10 samples are missing in 4 places' in odd.found
    assert ": 1 after 0.9" in odd.found and ", 3 after 1.4" in odd.found and ", 5 after 1.9" in odd.found
    assert " and 1 more (from the start)" in odd.found
    assert odd.write.startswith("resample = 0.01 at the top of the card")
    assert "begin with the rows 100, 149, 196 and … of the file" in odd.write


@pytest.mark.parametrize(
    "time",
    [
        EVEN + 0.0015 * np.random.default_rng(0).uniform(-1.0, 1.0, 400),  # jitter
        np.cumsum(np.tile([0.01] * 9 + [0.02], 40)),  # long steps are the rule
        np.where(np.arange(400) == 200, EVEN + 0.008, EVEN),  # one stamp is late
        EVEN
        + 0.007 * np.clip(np.arange(400) - 199, 0, 3),  # a loop that hangs for some samples, and goes on from there
        np.delete(EVEN, range(100, 140)),  # a gap, which is told as one
        EVEN[:2],
    ],
)
def test_no_lost_samples(time: np.ndarray) -> None:
    assert lost_samples(time) == ()


def test_lost_samples_of_several_experiments_are_one_warning() -> None:
    """Seen: the same advice three times, beside "time stamps are uneven" three times."""
    time = np.delete(EVEN, [100, 300])
    data = DataSet([recorded(name, time) for name in ("A", "B", "C", "D")], held_out_by_default=False)
    (odd,) = odd_time_stamps(data, {})
    assert odd.found.count("2 samples are missing in 2 places") == 3 and "and 1 more experiment," in odd.found
    assert "; write: resample = 0.01" in str(odd) and odd.write.count("100 and 299") == 3
    assert unevenness(time) == 1.0 and unevenness(time, lost=False) < 1e-6
