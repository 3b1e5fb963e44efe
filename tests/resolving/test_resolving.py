"""The bench, the judge and the page of the recordings that decide."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from experiments.resolving import bench, judging, machines
from experiments.resolving.loop import PHASES, SMALLER, random_input
from experiments.resolving.machines import MACHINES, QUESTIONS
from experiments.resolving.page import is_counted, text


@pytest.fixture(scope="module")
def car() -> bench.Bench:
    return bench.draw(1, 5)


def test_plants_share_nothing_with_the_tool() -> None:
    files = [Path(bench.__file__), *Path(machines.__file__).parent.glob("*.py")]
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [n for n in names if n.startswith("greybox_torch")], file.name


def test_every_question_has_answers() -> None:
    for question in QUESTIONS:
        catalogue = MACHINES[question.machine].catalogue
        assert all(catalogue[plan].accept for plan in question.plans)


def test_a_further_recording_begins_as_the_first_and_is_read_with_it(car, tmp_path: Path) -> None:
    again = car.record(car.runs[0].inputs, seed=9)
    assert np.abs(again.outputs - car.runs[0].outputs).max() < 12.0 * car.sigma.max()
    assert np.abs(again.states - car.runs[0].states).max() == 0.0
    car.write(tmp_path)
    data = gt.load_dataset(car.add(tmp_path, "designed", again))
    assert [r.name for r in data.recordings] == ["e0", "e1", "designed"]
    assert data.recordings[2].role == "estimation" and data.limits["deflection"]["upper"] == 0.08


def test_limits_of_the_machine(car) -> None:
    assert car.within(car.runs[0].inputs)
    assert not car.within(np.full_like(car.runs[0].inputs, 5.0))


def test_a_random_input_has_the_mean_square_of_the_designed_one(car, monkeypatch) -> None:
    """Also where the limits of the input cut its peaks off; it is made smaller only where no phases keep the machine within its limits."""
    square = np.where(np.arange(car.machine.samples) % 40 < 20, 0.4, -0.4)[:, None]
    monkeypatch.setattr(bench.Bench, "within", lambda self, inputs: True)
    found = random_input(car, square, np.random.default_rng(0))
    assert np.mean(found**2) == pytest.approx(0.16, rel=1e-3) and np.abs(found).max() == 0.5
    tried = []
    monkeypatch.setattr(bench.Bench, "within", lambda self, inputs: tried.append(inputs) or len(tried) > PHASES)
    smaller = random_input(car, square, np.random.default_rng(0))
    assert np.mean(tried[PHASES - 1] ** 2) == pytest.approx(0.16, rel=1e-3)
    assert np.mean(smaller**2) == pytest.approx(0.16 * SMALLER**2, rel=1e-3)


VERDICT = {
    "effects": [
        {
            "port": "a",
            "mechanism": "lag",
            "probability": 0.5,
            "alternatives": [{"port": "b", "mechanism": "lag", "probability": 0.3}],
            "one_of": {"members": [{"port": "b", "mechanism": "lag", "probability": 0.3}]},
        }
    ]
}


def test_probabilities_of_answers_are_added_once() -> None:
    assert judging.is_open(VERDICT) and not judging.is_open({"effects": []})
    assert judging.probability_of(VERDICT, {("a", "lag"), ("b", "lag")}) == pytest.approx(0.8)
    assert judging.probability_of(VERDICT, {("c", "lag")}) == 0.0
    assert judging.also_right([("a", "x")], [[("c", "x"), ("b", "x")], [("a", "x"), ("b", "x")]]) == {
        ("a", "x"),
        ("b", "x"),
        ("c", "x"),
    }


def test_what_leads_counts_with_what_no_input_tells_from_it() -> None:
    before = {("a", "lag"): 0.4, ("b", "lag"): 0.35, ("a", "delay"): 0.2}
    assert judging.leading(before, []) == 0.4
    assert judging.leading(before, [[("a", "lag"), ("b", "lag")]]) == pytest.approx(0.75)


def outcome(number: int, before: float, after: float, realised: float) -> dict:
    said = {"probability": after, "open": after < 0.9}
    return {
        "number": number,
        "open": True,
        "leading": max(before, 0.5),
        "question": "lag or delay",
        "effect": "lag",
        "before": before,
        "expected": 0.97,
        "designed": said,
        "random": {"probability": 0.5, "open": True},
        "predicted_nats": 40.0,
        "realised_nats": realised,
        "limits_kept": True,
        "limits_kept_in_simulation": True,
        "design_seconds": 2.0,
        "design_processor": 1.0,
    }


def test_the_page_counts_what_was_left_to_decide() -> None:
    told = [outcome(0, 0.4, 0.97, 35.0), outcome(1, 0.5, 0.02, 4.0), outcome(2, 0.95, 0.97, 30.0)]
    assert [is_counted(o) for o in told] == [True, True, False]
    about = {"commit": "abc", "date": "today", "processor": "a processor", "cores": "2"}
    page = text([*told, {"open": False}], "a command", about)
    assert "| left to decide | 2 |" in page and "| 4; 3 |" in page
    assert "1/2 (50 %" in page and "0/2 (0 %" in page and "2/3 (67 %" in page
    assert "| sure of a wrong answer: designed, random | 0, 0 |" in page
