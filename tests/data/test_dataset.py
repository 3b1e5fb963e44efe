"""A data set made in Python is what a card would make of the same samples."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from greybox_torch.data import Channel, DataSet, ParameterEntry, Recording, load_dataset
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import make_problem
from greybox_torch.systems import load_model

UNITS = {"voltage": "V", "speed": "rad/s"}


def run(name: str, role: Any = "estimation", units: Any = None, length: int = 20, **signals: Any) -> Recording:
    held = {"voltage": np.arange(float(length)), "speed": np.linspace(0, 1, length)} | signals
    return Recording.from_arrays(name, held, sample_time=0.01, role=role, units=units)


def test_defaults() -> None:
    data = DataSet([run("a", units=UNITS), run("b", "validation")])
    assert (data.name, data.hold, data.path, data.model) == ("recordings", "zoh", None, None)
    assert (data.parameters, data.initial, data.held_out_by_default) == ({}, {}, False)
    assert data.channels == {"voltage": Channel("voltage", "V"), "speed": Channel("speed", "rad/s")}
    assert [r.name for r in data.estimation()] == ["a"]
    assert [r.name for r in data.validation()] == ["b"]


def test_equals_what_a_card_makes_of_the_same_samples(bench: Path) -> None:
    card = load_dataset(bench / "dataset.toml")
    data = DataSet(
        [Recording.from_arrays(r.name, r.signals, sample_time=0.01, role=r.role, units=UNITS) for r in card.recordings],
        name="Bench motor",
        parameters={"J": {"value": 0.5, "lower": 0.0, "upper": 1.0}},
    )
    assert data.sha256 == card.sha256
    for field in ("name", "hold", "channels", "parameters", "initial", "held_out_by_default"):
        assert getattr(data, field) == getattr(card, field)


def test_last_quarter_is_held_out_where_no_role_is_validation() -> None:
    data = DataSet([run("a"), run("b", length=40)])
    assert data.held_out_by_default
    found = [(r.name, r.role, r.rows) for r in data.recordings]
    assert found[:2] == [("a", "estimation", (0, 15)), ("a (held out)", "validation", (15, 20))]
    assert found[3] == ("b (held out)", "validation", (30, 40))
    as_given = DataSet([run("a")], held_out_by_default=False)
    assert (len(as_given.recordings), as_given.held_out_by_default) == (1, False)


def test_replacing_a_field_keeps_the_others() -> None:
    data = DataSet([run("a")], name="Motor", parameters={"J": 0.5})
    other = dataclasses.replace(data, parameters={})
    assert (other.name, other.parameters, other.held_out_by_default) == ("Motor", {}, True)
    assert other.recordings == data.recordings
    fewer = dataclasses.replace(data, recordings=data.estimation())
    assert len(fewer.recordings) == 1
    assert fewer.sha256 != data.sha256


def test_parameters_in_each_of_their_ways() -> None:
    data = DataSet(
        [run("a")],
        parameters={"J": 0.5, "b": {"fixed": True}, "k": ParameterEntry(lower=0.0)},
        initial={"speed": {"value": 0.0, "fixed": True}},
    )
    assert data.parameters == {
        "J": ParameterEntry(value=0.5),
        "b": ParameterEntry(fixed=True),
        "k": ParameterEntry(lower=0.0),
    }
    assert data.initial["speed"].fixed


@pytest.mark.parametrize(
    ("recordings", "changes", "message"),
    [
        ([], {}, "DataSet, recordings: found none, expected at least one"),
        ([3], {}, "recordings: found an object of type int, expected recordings"),
        ([run("a"), run("a")], {}, '2 experiments are named "a"; expected different names'),
        (
            [run("a"), run("a (held out)")],
            {},
            'with the last quarter of each held out: 2 experiments are named "a (held out)"',
        ),
        (
            [run("a"), run("b", torque=np.ones(20))],
            {},
            '"b" has the channels voltage, speed, torque; expected those of "a"',
        ),
        (
            [run("a", units={"speed": "rpm"}), run("b", units=UNITS)],
            {},
            'channel "speed" has the units "rpm" in "a" and "rad/s"',
        ),
        (
            [run("a", speed=np.append(np.ones(15), [np.nan] * 5))],
            {},
            'recording "a (held out)", channel "speed": all 5 samples are',
        ),
        (
            [run("a", speed=np.append(np.ones(15), [np.nan] * 5))],
            {},
            'it is the last quarter, which is held out where no experiment has the role "validation": give one that role',
        ),
        ({"speed": np.ones(20)}, {}, "recordings: found an object of type dict, expected recordings"),
        (
            pd.DataFrame({"speed": np.ones(20)}),
            {},
            "recordings: found an object of type DataFrame, expected recordings",
        ),
        (None, {}, "recordings: found an object of type NoneType, expected recordings"),
        ([run("a")], {"hold": "zho"}, 'hold: found \'zho\', expected "zoh" or "foh"'),
        ([run("a")], {"name": ""}, "DataSet, name: found ''"),
        ([run("a")], {"parameters": {"J": "x"}}, 'DataSet, parameters, J: value: found "x", expected a number'),
        ([run("a")], {"parameters": {"J": {"valu": 1}}}, 'unknown key "valu" (did you mean "value"?)'),
        ([run("a")], {"parameters": {"J": {"lower": 1.0, "upper": 0.0}}}, "lower = 1 is not below upper = 0"),
        ([run("a")], {"initial": {"speed": float("inf")}}, "DataSet, initial, speed: value: found Infinity"),
    ],
)
def test_what_can_be_wrong(recordings: Any, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError) as error:
        DataSet(recordings, **changes)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (
            DataSet([run("a", units={"speed": "rpm"})], name="Bench"),
            "data set \"Bench\": channels speed: unit is 'rpm'",
        ),
        (
            DataSet([run("a", torque=np.ones(20))], name="Bench"),
            'data set "Bench": channels torque: model Motor has no such',
        ),
        (
            DataSet([run("a")], parameters={"JJ": 1.0}),
            'data set "recordings": argument parameters: JJ: model Motor has no such name',
        ),
        (
            DataSet([run("a")], initial={"w": 1.0}),
            'data set "recordings": argument initial: w: model Motor has no such name',
        ),
    ],
)
def test_a_model_that_does_not_fit_is_told_of_the_argument(data: DataSet, message: str, machines: Path) -> None:
    with pytest.raises(UserError) as error:
        make_problem(data, load_model(f"{machines / 'motor.py'}:Motor"), data.recordings)
    assert message in str(error.value)
    assert "None" not in str(error.value)
