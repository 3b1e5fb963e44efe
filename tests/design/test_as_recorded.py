"""Inputs that nobody sets are as they were recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import greybox_torch as gt
from greybox_torch.errors import UserError
from greybox_torch.experiment_design.approach import begun_there
from greybox_torch.experiment_design.as_recorded import as_recorded, continued, traces_of
from greybox_torch.experiment_design.limits import Range, limits_of

TIME: np.ndarray = 0.01 * np.arange(300)


@pytest.fixture
def zone(data_set):
    """A heater that is switched, and weather: a temperature, and a sun that is constant at night."""
    switched = np.repeat([0.0, 4.0, 0.0, 2.0, 4.0, 0.0], 50)
    own = {"heater": switched, "outside": np.sin(TIME), "sun": np.maximum(np.sin(6 * TIME), 0.0)}
    return data_set({"heater": "W", "outside": "K", "sun": "W"}, [own] * 2)


def test_what_was_never_set_in_steps_is_kept_where_other_inputs_were(zone) -> None:
    """Seen: an outside temperature that was to follow a triangle wave."""
    names = ["heater", "outside", "sun"]
    assert as_recorded(zone, names, {}) == ("outside", "sun")
    assert as_recorded(zone, names, {"sun": {"upper": 1.0}, "outside": {"rate": 1.0}}) == ("outside",)
    assert as_recorded(zone, names, {"heater": "recorded"}) == ("heater",)
    assert as_recorded(zone, ["outside", "sun"], {}) == ()  # nothing shows which of them is set


@example(0, 1e-16, 20)  # most samples are exactly as the last, some off by a last digit
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.02), st.integers(5, 60))
@example(0, 2.220446049250313e-16, 60)
@example(1, 1e-15, 30)
def test_steps_are_seen_through_the_noise_of_a_value_read_back(seed: int, noise: float, hold: int) -> None:
    """Seen: a heater's power, set every 20 min and read back with noise, told as never set in steps."""
    rng = np.random.default_rng(seed)
    levels = np.cumsum(rng.uniform(0.5, 2.0, 12) * rng.choice([-1.0, 1.0], 12))
    time = np.arange(12 * hold)
    own = {
        "heater": np.repeat(levels, hold) + rng.normal(0.0, noise, len(time)),
        "outside": np.sin(time / hold) + rng.normal(0.0, noise, len(time)),
        "gusts": np.cumsum(rng.standard_normal(len(time))),
        "y": time,
    }
    data = gt.DataSet([gt.Recording.from_arrays("day", own, sample_time=1.0)])
    assert as_recorded(data, ["heater", "outside", "gusts"], {}) == ("outside", "gusts")


@given(st.integers(0, 2**32 - 1), st.floats(1e-6, 0.02), st.floats(0.0, 4.0), st.integers(1, 4))
def test_an_input_that_rests_in_some_recordings_is_set_in_others(
    seed: int, noise: float, rest: float, resting: int
) -> None:
    """Seen: a heater stepped in three experiments, and held at a value that is read back with noise in a fourth."""
    rng = np.random.default_rng(seed)
    own = {"heater": np.repeat([0.0, 4.0, 0.0, 2.0, 4.0, 0.0], 50), "outside": np.sin(TIME), "y": TIME}
    stepped = own | {"heater": own["heater"] + rng.normal(0.0, noise, len(TIME))}
    resting_runs = [own | {"heater": rest + rng.normal(0.0, noise, len(TIME))} for _ in range(resting)]
    runs = [
        gt.Recording.from_arrays(f"day {k}", one, sample_time=1.0) for k, one in enumerate([*resting_runs, stepped])
    ]
    assert as_recorded(gt.DataSet(runs), ["heater", "outside"], {}) == ("outside",)


def test_an_input_with_a_range_or_under_a_loop_is_set(zone) -> None:
    """Seen: an outside temperature that was to follow a triangle wave, since the heater had its limits."""
    assert as_recorded(zone, ["heater", "outside", "sun"], {"heater": {"lower": 0, "upper": 4}}) == ("outside", "sun")
    assert as_recorded(zone, ["outside", "sun"], {}, driven=True) == ("outside", "sun")
    assert as_recorded(zone, ["outside", "sun"], {"sun": {"upper": 1.0}}, driven=True) == ("outside",)


def test_a_trace_has_the_step_of_the_next_recording() -> None:
    """Seen: weather sampled every 60 s that ran a sixth as fast, 10 s to a sample."""
    time = np.array([7.0, 8.0, 9.0, 12.0, 13.0])  # a gap
    values = np.array([0.0, 1.0, np.nan, 5.0, 4.0])
    recording = gt.Recording.from_arrays(
        "day", {"outside": np.append(values, [3] * 5), "y": np.ones(10)}, time=[*time, *range(14, 19)]
    )
    assert traces_of(recording, ["outside"], 1.0)["outside"].tolist() == [0, 1, 2, 3, 4, 5, 4, 3, 3, 3, 3, 3]
    assert traces_of(recording, ["outside"], 2.0)["outside"].tolist() == [0, 2, 4, 4, 3, 3]
    assert traces_of(recording, ["outside"], 0.5)["outside"][:4].tolist() == [0, 0.5, 1, 1.5]


def test_a_trace_is_continued_without_a_jump() -> None:
    assert continued(np.array([0.0, 1.0, 2.0]), 8).tolist() == [0, 1, 2, 1, 0, 1, 2, 1]
    assert continued(np.array([3.0]), 2).tolist() == [3.0, 3.0]


def test_an_input_as_recorded(undecided) -> None:
    found = gt.design(undecided, seconds=4.0, limits={"voltage": "recorded"})
    recorded = undecided.data.recordings[0].signals["voltage"]
    assert found.limits.designed == [] and len(recorded) == 300
    np.testing.assert_array_equal(found.inputs["voltage"][:300], recorded)
    assert (found.inputs["voltage"][300:] == recorded[-2:-102:-1]).all()
    assert found.content(undecided.data.path)["inputs"] == {"voltage": {"kind": "as recorded", "recording": "steps"}}
    notes = " ".join(found.notes)
    assert (
        "Kept as in steps, as asked for: voltage. The predicted differences hold for these inputs "
        "(beyond the end of that recording, backwards); record what really occurs." in notes
    )
    unasked = replace(found, limits=replace(found.limits, not_in_steps=("voltage",)))
    assert any(
        "Kept as in steps: voltage, never set in steps, given a range or driven" in line for line in unasked.notes
    )


def test_an_output_is_never_as_recorded(undecided) -> None:
    with pytest.raises(UserError, match=r'speed: found "recorded"; expected \{ lower .* or some of these$'):
        gt.design(undecided, limits={"speed": "recorded"})


def test_a_trace_takes_the_place_of_a_command(undecided) -> None:
    limits = limits_of(undecided.data, undecided.model.plain, {"voltage": "recorded"}, "[limits]")
    assert (begun_there(np.zeros((1, 300)), TIME, limits)[0] == undecided.data.recordings[0].signals["voltage"]).all()


def test_a_limit_that_keeps_an_input_small_is_told(undecided) -> None:
    found = gt.design(undecided, seconds=2.0, limits={"voltage": {"lower": -40.0, "upper": 40.0}})
    assert any(line.startswith("Small is voltage (") and "as speed is not to pass" in line for line in found.notes)
    roomy = replace(found, limits=replace(found.limits, outputs={"speed": Range(-1e6, 1e6)}))
    assert not any(line.startswith("Small is") for line in roomy.notes)
