"""The row of a verdict, of a data set that ends its workers, and what a model's file leaves behind in a worker."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.effect import Curve, Effect
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score
from greybox_torch.fleets.isolation import own_registrations
from greybox_torch.fleets.job import Job
from greybox_torch.fleets.killed import killed_row
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.store import ROW
from greybox_torch.fleets.verdict_row import row_of_verdict
from greybox_torch.mechanisms.library import LIBRARY

SMALL = Effect(
    "rotor",
    "gravity",
    0.7,
    ("position",),
    "",
    {"a": {"value": 0.01, "std": 0.1, "unit": "N m"}},
    0.1,
    (),
    None,
    size=0.1,
)
LARGE = Effect(
    port="actuator",
    mechanism="input_lag",
    probability=0.4,
    signals=("voltage",),
    where="",
    parameters={"T": {"value": 0.002, "std": 1e-4, "unit": "s"}},
    explained=0.9,
    alternatives=(),
    curve=None,
    size=0.9,
)
RECORDED = Row("line1/pump", "/in/line1/pump/dataset.toml", "failed", machine="pump", recorded="2026-03-01")


def verdict(*effects: Effect, **more: Any) -> Verdict:
    fits = {
        "start": (10.0, 20.0),
        "refit": (70.0, 80.0),
        "augmented": (90.0, float("nan") if more.pop("overflow", 0) else 95.0),
    }
    scores = {
        name: (Score("a", "estimation", "y", a, 1.0), Score("b", "validation", "y", b, 1.0))
        for name, (a, b) in fits.items()
    }
    return Verdict("Pump", "Motor", 0, 3.0, 0.9, effects, scores, (), {}, (), **more)


def test_the_largest_effect_leads() -> None:
    given = {"J": {"value": 0.02, "std": None, "unit": "kg m^2"}}
    row = row_of_verdict(verdict(SMALL, LARGE), given, RECORDED)
    assert (row.answer, row.effect, row.port, row.mechanism) == (
        "named",
        "input lag at actuator",
        "actuator",
        "input_lag",
    )
    assert (row.parameter, row.value, row.std, row.unit, row.probability) == ("T", 0.002, 1e-4, "s", 0.4)
    assert (row.fit_before, row.fit_after, row.key_parameter) == (80.0, 95.0, "actuator.input_lag.T")
    assert (row.dataset, row.machine, row.recorded, row.title) == ("line1/pump", "pump", "2026-03-01", "Pump")
    assert (row.report, row.parameters) == ("line1/pump/report.html", given)


def test_what_cannot_be_told_apart_is_one_statement() -> None:
    one_of = OneOf("about 2 ms pass", 0.97, (Alternative("actuator", "input_lag", 0.4),))
    row = row_of_verdict(verdict(replace(LARGE, one_of=one_of)), {}, RECORDED)
    assert (row.effect, row.probability) == ("about 2 ms pass", 0.97)


def test_a_curve_has_no_key_parameter() -> None:
    curve = Curve("speed", "rad/s", np.zeros(2), np.zeros(2), "N m")
    unknown = replace(
        LARGE, mechanism="unknown", parameters={"h_1": {"value": 1.0, "std": 0.1, "unit": ""}}, curve=curve
    )
    given = {"J": {"value": 1.0}, "actuator.unknown.h_1": {"value": 1.0}}
    row = row_of_verdict(verdict(unknown), given, RECORDED)
    assert (row.answer, row.parameter, row.key_parameter, list(row.parameters)) == ("unknown", "", "", ["J"])


@pytest.mark.parametrize(
    ("told", "answer"),
    [
        ({}, "nothing"),
        ({"complete": False}, "unfinished"),
        ({"unexplained": 5.0}, "unknown"),
        ({"unexplained": 5.0, "complete": False}, "unfinished"),  # seen: "something without a name"
        ({"unexplained": 5.0, "complete": False, "too_short": "too short"}, "unknown"),
    ],
)
def test_without_effects(told: dict[str, Any], answer: str) -> None:
    row = row_of_verdict(verdict(**told), {}, RECORDED)
    assert (row.answer, row.effect, row.fit_before, row.fit_after) == (answer, "", 80.0, 80.0)


def test_a_fit_that_is_no_number() -> None:
    assert row_of_verdict(verdict(LARGE, overflow=True), {}, RECORDED).fit_after is None


def test_what_ends_workers_is_a_row(job: Job) -> None:
    row = killed_row(job)
    assert (row.answer, row.failure, row.machine) == ("failed", "killed", "pump")
    assert json.loads((job.folder / ROW).read_text()) == row.as_json()
    job.card.write_text("[")
    assert killed_row(job).failure == "killed"


def test_registrations_end_with_the_data_set() -> None:
    before = dict(LIBRARY)
    with pytest.raises(ZeroDivisionError), own_registrations():
        LIBRARY.clear()
        raise ZeroDivisionError
    assert before == LIBRARY
