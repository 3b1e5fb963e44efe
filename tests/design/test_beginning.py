"""How a designed recording begins: at rest where an earlier one did, as asked for, and with the set point where its output stands."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.design_files import CARD
from greybox_torch.api.design_notes import _beginning, _fastest, design_notes
from greybox_torch.data.card import read_card
from greybox_torch.errors import UserError
from greybox_torch.experiment_design.approach import begun_at, begun_there
from greybox_torch.experiment_design.beginning import beginning_of
from greybox_torch.experiment_design.contender import Contender, contender
from greybox_torch.experiment_design.controller import Loop
from greybox_torch.experiment_design.limits import Limits, Range

RANGE = Range(-5.0, 5.0, 10.0)


def two(undecided, first: float, second: float) -> Contender:
    """The motor's hypothesis of dry friction on two recordings that begin at these speeds."""
    starts = {"steps": {"speed": first}, "more": {"speed": second}}
    return contender("friction", 0.5, undecided.model, undecided.data, starts)


@pytest.mark.parametrize(
    ("speeds", "like", "moving"),
    [
        ((2.0, 0.0), "more", ()),
        ((0.0, 0.0), "steps", ()),
        ((2.0, 1.0), "steps", ("speed",)),
        ((0.01, 0.0), "steps", ()),
    ],
)
def test_a_recording_that_begins_at_rest_is_preferred(undecided, speeds, like: str, moving: tuple[str, ...]) -> None:
    """Seen: a design that began in mid-swing, as the first of the recordings did."""
    one = two(undecided, *speeds)
    begins = beginning_of(one, {})
    assert (begins.like, begins.moving) == (like, moving) and begins.resting == (() if moving else ("speed",))
    assert one.beginning(like, {}).start["speed"] == speeds[like == "more"]


def test_limits_that_are_not_given_are_told_with_what_was_taken(undecided, tmp_path: Path) -> None:
    found = gt.design(undecided, precision="J", seconds=0.5, limits={})
    (told,) = [note for note in found.notes if "[limits]" in note and note.startswith("No limits")]
    low, high = found.limits.inputs["voltage"].lower, found.limits.inputs["voltage"].upper
    assert "No limits are given under [limits] on the card (in Python limits=): the recorded range was taken, " in told
    assert (
        f"for voltage ({low:.4g} to {high:.4g} V), with 10 % more either way for speed (" in told and " rad/s)" in told
    )
    found.save(tmp_path)
    assert f"# {told}\n" in (tmp_path / CARD).read_text() and read_card(tmp_path / CARD)
    some = gt.design(undecided, precision="J", seconds=0.5, limits={"voltage": {"lower": -3.0, "upper": 3.0}})
    assert any(n.startswith("Not all limits are") and "for voltage" not in n for n in some.notes)
    every = gt.design(undecided, precision="J", seconds=0.5)
    assert not any("limits are given" in note for note in every.notes)


def test_changes_that_nothing_limits_are_told(undecided) -> None:
    """Seen: a set point of 740 rad/s for a motor's angle, and no word of the rate that was not given."""
    slow = np.linspace(-3.0, 3.0, len(undecided.data.recordings[0].time))
    runs = [replace(r, signals={**r.signals, "voltage": slow[: len(r.time)]}) for r in undecided.data.recordings]
    data = replace(undecided.data, recordings=tuple(runs))

    def told(data: gt.DataSet, **rate: float) -> list[str]:
        limits = {"voltage": {"lower": -3.0, "upper": 3.0, **rate}}
        found = gt.design(undecided, precision="J", seconds=0.5, limits=limits)
        return [note for note in design_notes(replace(found, data=data)) if note.startswith("Nothing limits how fast")]

    (note,) = told(data)
    assert "voltage changes: here by" in note and "voltage = { rate = … }" in note
    assert not told(data, rate=10.0) and not told(undecided.data), "recorded in steps of that size"


def test_the_fastest_change_is_over_the_time_between_samples_of_the_design() -> None:
    """Seen: noise of 0.1 from one sample to the next, 1 ms later, taken for a rate of 100 per second over 0.1 s."""
    noise = np.where(np.arange(1000) % 2, 0.05, -0.05)
    data = gt.DataSet([gt.Recording.from_arrays("a", {"u": noise}, sample_time=0.001, role="estimation")])
    assert _fastest(data, "u", 0.1) <= 0.1 and _fastest(data, "u", 0.001) == pytest.approx(0.1)
    ramp = gt.DataSet([gt.Recording.from_arrays("a", {"u": np.arange(100.0)}, sample_time=0.5, role="estimation")])
    assert _fastest(ramp, "u", 2.0) == pytest.approx(4.0) and _fastest(ramp, "u", 0.1) == pytest.approx(0.2)


def test_a_start_that_is_asked_for(undecided) -> None:
    moving = gt.design(undecided, precision="J", seconds=0.5)
    assert moving.moving == ("speed",) and moving.start == {"speed": 2.0}
    assert any("start = { speed = 0 }" in line for line in moving.notes)
    assert "Begin as steps began: speed = 2 rad/s." in moving.notes, "seen: motor_angle = 0.00367, without its unit"
    noise = replace(moving, moving=(), resting=("speed",), start={"speed": -0.00394})
    assert "Begin as steps began: speed at rest." in noise.notes, "seen: speed = -0.00394"
    limits = {**undecided.data.limits, "start": {"speed": 0.0}}
    rest = gt.design(undecided, precision="J", seconds=0.5, limits=limits)
    assert rest.start == {"speed": 0.0} and rest.moving == () and abs(rest.outputs[0][0, 0]) < 1e-12
    assert "Begin with speed = 0 rad/s: speed as asked for, all else as steps began." in rest.notes


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"sped": 0.0}, "start: no state is named sped"),
        (3, "start: found 3, expected states"),
        ({"speed": "fast"}, "start, speed: found 'fast', expected a number"),
    ],
)
def test_starts_at_fault(undecided, start: Any, message: str) -> None:
    with pytest.raises(UserError, match=message):
        gt.design(undecided, precision="J", limits={**undecided.data.limits, "start": start})


def test_a_set_point_begins_where_its_output_stands() -> None:
    """Seen: at 12.5 rad, with the motor at 23.8 rad, so that the first sample commanded the limit."""
    time = 0.01 * np.arange(400)
    limits = Limits(4.0, {"u": Range(-1.0, 1.0)}, {}, {}, {"u": RANGE}, begin={"u": 4.0})
    asked = -2.0 + np.sin(3.0 * time)
    (found,) = begun_there(asked[None], time, limits)
    assert found[0] == 4.0 and np.abs(np.diff(found)).max() <= 10.0 * 0.01 * (1 + 1e-9)
    met = int(np.argmax(found == asked))
    assert 40 < met < 80 and (found[met:] == asked[met:]).all()
    np.testing.assert_array_equal(
        begun_there(asked[None], time, Limits(4.0, limits.inputs, {}, {}, {"u": RANGE}))[0], asked
    )


def test_where_the_output_stands(undecided) -> None:
    loop = Loop(driven=0, measured=0, lower=-3.0, upper=3.0, step=0.01, gain=1.0)
    one = contender("friction", 0.5, undecided.model, undecided.data, {"steps": {"speed": 2.0}}, [loop])
    limits = Limits(1.0, {"voltage": Range(-3.0, 3.0)}, {}, {}, {"voltage": Range(-7.0, 7.0)})
    assert begun_at(one, limits, 0.01) == {"voltage": pytest.approx(2.0)}


def test_an_input_of_a_limited_rate_begins_where_it_stood(undecided) -> None:
    """Seen: 200 V/s at most, and 22 V at the first sample of a motor at rest."""
    stood = undecided.data.recordings[0].signals["voltage"][0]
    limits = {**undecided.data.limits, "voltage": {"lower": -3.0, "upper": 3.0, "rate": 20.0}}
    found = gt.design(undecided, precision="J", seconds=0.5, limits=limits)
    voltage = found.inputs["voltage"]
    assert voltage[0] == stood and np.abs(np.diff(voltage)).max() <= 20.0 * 0.01 * (1 + 1e-9)
    assert any(f"begins with voltage = {stood:.4g} V" in note for note in found.notes)
    far = gt.design(
        undecided, precision="J", seconds=0.5, limits={**limits, "voltage": {"lower": -3, "upper": -1, "rate": 20.0}}
    )
    assert far.inputs["voltage"][0] == -1.0
    free = gt.design(undecided, precision="J", seconds=0.5)
    assert not free.limits.begin and not any("limited rate" in note for note in free.notes)


def test_a_start_state_that_no_sensor_shows_is_told_as_an_estimate() -> None:
    """Seen: "Begin … twist = -4.22e-05 rad", which nobody can set."""
    states = (SimpleNamespace(name="speed", unit="rad/s"), SimpleNamespace(name="twist", unit="rad"))
    found: Any = SimpleNamespace(
        hypotheses=(SimpleNamespace(states=states),),
        start={"speed": 2.0, "twist": -4.22e-5},
        resting=(),
        moving=(),
        data=SimpleNamespace(channels={"speed": SimpleNamespace(unit="rad/s")}),
        limits=SimpleNamespace(start={}, begin={}),
        begins_like="steps",
        inputs={},
    )
    assert list(_beginning(found)) == [
        "Begin as steps began: speed = 2 rad/s, by the estimate twist = -4.22e-05 rad, which no sensor shows."
    ]


def test_reversals_are_told_as_the_triangle_wave_that_they_are(undecided) -> None:
    """Seen: "15 s of reversals", a triangle of 36 to 52 N m."""
    found = gt.design(undecided, precision="J", seconds=0.5)
    turning = replace(found, excitations=tuple(replace(e, kind="reversals") for e in found.excitations))
    assert "s of a triangle wave are expected to" in turning.sentence and turning.excitations[0].kind == "reversals"


@pytest.mark.parametrize(("memory", "told"), [(1.0, "take errors for independent"), (40.0, "over up to 40 samples")])
def test_why_a_deviation_is_not_the_reports_is_told_whatever_the_errors_are(
    undecided, memory: float, told: str
) -> None:
    """Seen: "from 2.2 to 1.4 N s/m" beside ± 1.65 in the report, without a word, as errors were white."""
    found = replace(gt.design(undecided, precision="J", seconds=0.5), memory=memory)
    (note,) = [one for one in found.notes if one.startswith("Both deviations")]
    assert told in note and "The report's ± and greybox fit" in note
    assert not any(one.startswith("Both deviations") for one in replace(found, parameter=None).notes)
