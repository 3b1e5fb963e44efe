"""Steps of stamps that floats round: seconds since 1970 hold a quarter of a microsecond."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from greybox_torch.data import DataSet, Recording, load_dataset
from greybox_torch.data.steps import steps_of, unevenness, usual_step
from greybox_torch.simulation.records import make_records
from greybox_torch.systems import load_model

SINCE_1970 = 1_772_366_400.0
RATES = [100.0, 1e4, 5e4, 1e6]


def dated(step: float, count: int = 2000) -> NDArray[np.float64]:
    return SINCE_1970 + np.arange(count) * step


@pytest.mark.parametrize("rate", RATES)
def test_what_floats_round_is_no_step(rate: float) -> None:
    """Seen: 10 kHz told as a sample time of 9.98974e-05 s, and 50 kHz as uneven."""
    time = dated(1.0 / rate)
    assert usual_step(time) == pytest.approx(1.0 / rate, abs=3e-10)
    assert unevenness(time) == 0.0
    np.testing.assert_array_equal(steps_of(time), usual_step(time))


@given(
    st.integers(1, 999), st.sampled_from([1e-4, 1e-5]), st.integers(200, 3000), st.floats(0.0, 3e8), st.integers(0, 3)
)
def test_a_step_is_the_number_that_one_would_write(
    number: int, unit: float, count: int, later: float, gaps: int
) -> None:
    """Seen: "samples 0.00199999998 s apart" on the card of a design, of date stamps of 2 ms."""
    step = float(f"{number * unit:.3g}")
    kept = np.ones(count, dtype=bool)
    for k in range(min(gaps, count // 300)):  # more of them are no gaps: the logger writes when something changes
        kept[(k + 1) * count // 4 : (k + 1) * count // 4 + 20] = False
    assert usual_step((later + dated(step, count))[kept]) == step


def test_a_gap_stays_a_gap() -> None:
    time = np.delete(dated(1e-4), range(1000, 1100))
    assert usual_step(time) == pytest.approx(1e-4, abs=3e-10)
    assert unevenness(time) == pytest.approx(100.0, rel=1e-2)
    assert unevenness(time, gaps=False) == 0.0
    assert steps_of(time)[999] == np.diff(time)[999]


@pytest.mark.parametrize(
    "time",
    [np.arange(2000) * 1e-3, 1e5 + np.arange(2000) * 0.1, dated(1.0), dated(1e-2) + 1e-4 * np.sin(np.arange(2000.0))],
)
def test_other_stamps_are_taken_as_they_are(time: NDArray[np.float64]) -> None:
    np.testing.assert_array_equal(steps_of(time), np.diff(time))
    assert usual_step(time) == np.median(np.diff(time))


@pytest.mark.parametrize("rate", [1e4, 5e4])
def test_dates_of_a_file(tmp_path: Path, rate: float) -> None:
    rows = [f"2026-03-01T12:00:{k / rate:09.6f},{k}" for k in range(2000)]
    (tmp_path / "log.csv").write_text("\n".join(["t,u", *rows]))
    (tmp_path / "dataset.toml").write_text(
        'time = "t"\n[channels]\nu = { column = "u" }\n[[experiment]]\nname = "run"\nfile = "log.csv"\nrole = "estimation"\n'
    )
    (run, *_) = load_dataset(tmp_path / "dataset.toml").recordings
    assert run.sample_time == pytest.approx(1.0 / rate, abs=3e-10)
    assert run.time[0] == SINCE_1970 and not run.notes


def test_simulations_take_such_steps_as_even() -> None:
    model = load_model("robot_arm")
    names = [signal.name for signal in (*model.inputs, *model.outputs)]
    run = Recording.from_arrays("run", dict.fromkeys(names, np.ones(2000)), time=dated(1e-4))
    records = make_records(DataSet([run]), model, [run])
    np.testing.assert_allclose(records.dt, 1e-4, rtol=3e-6)
