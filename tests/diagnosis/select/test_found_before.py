"""What a search with fewer experiments came to, offered to the next with its values."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.hypothesis.fit import hypothesis
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.found_before import with_found_before
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction, QuadraticDrag
from greybox_torch.mechanisms.unknown import Unknown


@pytest.fixture(scope="session")
def drag_search(motor_data, motor, begun):
    return begun(motor_data(torque=lambda q, v: -0.004 * v * abs(v)), motor)


def knowing(search, effects, values):
    """A state that knows what a search with fewer experiments came to: ``effects`` with ``values``."""
    start = search.plain.values() | values
    found = hypothesis(search.problem, effects, search.surroundings, [start], options=search.study.options)
    assert found is not None
    return replace(search.state, found_before=found), found


def test_a_law_that_was_found_is_tried_from_its_values_first(motor, drag_search) -> None:
    drag = attach(motor, "rotor", QuadraticDrag())
    state, before = knowing(drag_search, (drag,), {"rotor.quadratic_drag.c": 0.003})
    screened = Candidate(attach(motor, "rotor", QuadraticDrag()), ({"a": 1.0}, {"b": 1.0}, {"c": 1.0}), 0.8)
    other = Candidate(attach(motor, "rotor", CoulombFriction()), ({"d": 1.0},), 0.3)
    first, second = with_found_before(drag_search.study, state, [screened, other], curves=True)
    assert first.first_starts(2) == (before.values(), {"a": 1.0}, {"b": 1.0}) and first.explained == 0.8
    assert second is other
    (alone,) = with_found_before(drag_search.study, state, [], curves=True)
    assert alone.first_starts(2) == (before.values(),), "it is offered where the screen passes over it, too"
    assert with_found_before(drag_search.study, state.at(before), [], curves=True) == [], "it is there already"


def test_a_curve_that_was_found_is_offered_as_it_was_drawn(motor, drag_search) -> None:
    curve = attach(motor, "rotor", Unknown("speed", 16, left_out=(3,)))
    heights = {f"{curve.prefix}.w_{k}": 0.01 for k in range(16) if k != 3}
    state, before = knowing(drag_search, (curve,), heights)
    coarse = Candidate(attach(motor, "rotor", Unknown("speed", 8)), ({"a": 1.0},), 0.8, steps=100)
    (found,) = with_found_before(drag_search.study, state, [coarse], curves=True)
    (start,) = found.first_starts(2)
    assert found.explained == 0.8 and found.steps == 100
    attached = found.attachment
    assert isinstance(attached.mechanism, Unknown) and attached.mechanism.bumps == list(range(16))
    frozen = frozenset(n for n in start if ".w_" in n)
    study = drag_search.study
    as_before = hypothesis(
        study.problem, (attached,), study.surroundings, [start], options=study.options, frozen=frozen
    )
    assert as_before is not None and as_before.score < before.score + 0.02
    assert with_found_before(drag_search.study, state, [], curves=False) == []


def test_a_first_search_is_offered_nothing_more(drag_search) -> None:
    assert with_found_before(drag_search.study, drag_search.state, [], curves=True) == []


def test_a_curve_over_what_the_experiments_do_not_show_now_is_not_offered(motor, drag_search) -> None:
    """Seen: a robot's friction along the motor's voltage, found on a run that turned round: KeyError, along@u, on the next experiment."""
    curve = attach(motor, "rotor", Unknown("speed", 16))
    state, _ = knowing(drag_search, (curve,), {f"{curve.prefix}.w_{k}": 0.01 for k in range(16)})
    around = drag_search.study.surroundings
    ranges = {n: r for n, r in around["rotor"].ranges.items() if n != "speed"}
    study = replace(drag_search.study, surroundings={**around, "rotor": replace(around["rotor"], ranges=ranges)})
    assert with_found_before(study, state, [], curves=True) == []
