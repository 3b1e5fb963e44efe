"""Rivals of an early choice, beside what was found later: asked again, and by held-out experiments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.promotion import promote_for_a_rival
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.rivals_beside import rivalled_beside_others, rivals_in_its_place
from greybox_torch.diagnosis.select.search import revise
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction, QuadraticDrag
from greybox_torch.mechanisms.unknown import Unknown

ROLES = ("estimation", "validation", "validation")


@pytest.fixture(scope="module")
def told(motor_data, motor, begun):
    """Makes a search on a motor with drag and a bias, its data, and the state with ``first`` chosen before the bias, beside ``rival``."""
    data = motor_data(roles=ROLES, torque=lambda q, v: -0.01 * v * abs(v) + 0.02)
    search = begun(data, motor)
    laws = {law.name: attach(motor, "rotor", law) for law in (CoulombFriction(), QuadraticDrag())}
    alone = {
        name: judged(
            Candidate(law, (), 0.5), search.plain, search.refitted((law,), search.plain), search.study.settings
        )
        for name, law in laws.items()
    }
    bias = attach(motor, "rotor", ConstantBias())

    def make(first: str, rival: str) -> tuple:
        step = SelectionStep((), search.plain, (alone[first], alone[rival]), alone[first])
        fitted = search.refitted((laws[first], bias), search.plain)
        return search, data, replace(search.state.at(fitted), steps=(step,)), laws

    return make


def test_a_rival_that_does_as_well_beside_later_effects_makes_a_choice_doubtful(told) -> None:
    """Seen: a lag of an actuator, told as a dead time (0.97), which did better as long as a stop was missing."""
    search, _, wrong, laws = told("coulomb_friction", "quadratic_drag")
    assert rivalled_beside_others(search.study, wrong, laws["coulomb_friction"])
    search, _, right, laws = told("quadratic_drag", "coulomb_friction")
    assert not rivalled_beside_others(search.study, right, laws["quadratic_drag"])
    assert not rivalled_beside_others(search.study, replace(right, steps=()), laws["quadratic_drag"]), (
        "no step on record"
    )


def test_what_lost_by_more_than_was_missing_is_not_asked_again(told) -> None:
    search, _, state, laws = told("coulomb_friction", "quadratic_drag")
    (step,) = state.steps
    lost = step.ranked[1]
    fits = tuple(replace(f, mean_square=1e6 * f.mean_square) for f in lost.fitted.fits)
    far = replace(step, ranked=(step.ranked[0], replace(lost, fitted=replace(lost.fitted, fits=fits))))
    assert list(rivals_in_its_place(search.study, state, laws["coulomb_friction"]))
    assert not list(rivals_in_its_place(search.study, replace(state, steps=(far,)), laws["coulomb_friction"]))


def test_held_out_experiments_that_speak_for_a_rival_join_those_to_choose_with(told) -> None:
    search, data, wrong, _ = told("coulomb_friction", "quadratic_drag")
    more = promote_for_a_rival(search.study, data, wrong, HeldOut(data, search.study))
    assert more is not None and more.taken in {r.name for r in data.validation()}
    assert more.why == "quadratic drag at rotor instead of Coulomb friction at rotor predicts it better"
    assert len(more.dataset.validation()) == 1


def test_not_where_what_was_found_is_right_or_no_experiment_would_be_left(told) -> None:
    search, data, right, _ = told("quadratic_drag", "coulomb_friction")
    assert promote_for_a_rival(search.study, data, right, HeldOut(data, search.study)) is None
    search, data, wrong, _ = told("coulomb_friction", "quadratic_drag")
    less = replace(data, recordings=data.recordings[:2])
    assert promote_for_a_rival(search.study, less, wrong, HeldOut(less, search.study)) is None
    assert promote_for_a_rival(search.study, data, search.state, HeldOut(data, search.study)) is None, (
        "nothing was found"
    )


@pytest.mark.parametrize("gone", [True, False])
def test_a_curve_that_stands_alone_at_last_is_asked_for_a_name(motor_data, motor, begun, gone: bool) -> None:
    """Seen: a knee's stop, told as a curve: three laws stood for parts of it until the curve came, and fell away beside it."""
    search = begun(motor_data(torque=lambda q, v: -0.06 * np.tanh(v / 0.2)), motor)
    curve, other = attach(motor, "rotor", Unknown("speed", 24)), attach(motor, "rotor", ConstantBias())
    begin = {f"{curve.prefix}.w_{k}": 0.02 * (1 if k < 12 else -1) for k in range(24)}
    fitted = search.refitted((curve,), search.plain, [search.plain.values() | begin])
    parent = search.refitted((other,), search.plain) if gone else search.plain
    taken = judged(Candidate(curve, (), 0.5), parent, fitted, search.study.settings)
    step = SelectionStep((), parent, (taken,), taken)
    state = SearchState(search.plain, fitted, (step,), without={curve.prefix: search.plain})
    revised = result_of(revise(search.study, state))
    assert {e.mechanism.name for e in revised.effects} == ({"coulomb_friction"} if gone else {"unknown"})


def test_what_was_found_itself_is_no_rival_of_what_was_found_before(told) -> None:
    """Seen: a servo's pendulum, told as "Coulomb friction, or a sensor's lag" and the sensor's lag."""
    search, _, state, laws = told("coulomb_friction", "quadratic_drag")
    (step,) = state.steps
    bias = replace(step.ranked[1], candidate=Candidate(state.effects[1], (), 0.5))
    state = replace(state, steps=(replace(step, ranked=(*step.ranked, bias)),))
    told_step = state.step_beside_others(laws["coulomb_friction"].prefix)
    assert told_step is not None and told_step.ranked == step.ranked and told_step.taken is step.taken
    assert state.step_beside_others(state.effects[1].prefix) is None, "no step on record"
