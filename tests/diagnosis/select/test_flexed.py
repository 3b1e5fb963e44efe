"""A law found flexes before another is named beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.flexed import flexed, wider_laws
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction, QuadraticDrag
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.torque_ripple import TorqueRipple


@pytest.fixture(scope="module")
def sticking(motor_data, motor, begun):
    """A search on a motor that sticks a little more than it slides, Coulomb friction found, and what may follow."""
    search = begun(
        motor_data(torque=lambda q, v: -(0.05 + 0.04 * np.exp(-((v / 0.8) ** 2))) * np.tanh(v / 0.05)), motor
    )
    dry, wide = attach(motor, "rotor", CoulombFriction()), attach(motor, "rotor", StribeckFriction())
    start = {f"{wide.prefix}.F_c": 0.05, f"{wide.prefix}.F_s": 0.03, f"{wide.prefix}.v_s": 0.8}
    fits = {
        e.prefix: search.refitted((e,), search.plain, [search.plain.values() | start | {f"{dry.prefix}.F_c": 0.05}])
        for e in (dry, wide)
    }
    ranked = tuple(
        judged(Candidate(e, (), 0.5), search.plain, fits[e.prefix], search.study.settings) for e in (wide, dry)
    )
    step = SelectionStep((), search.plain, ranked, ranked[1])
    return search.study, replace(search.state.at(fits[dry.prefix]), steps=(step,)), fits, wide


def after(study, before, effect, score_below):
    """``before`` with one more effect, whose score is that much below."""
    fitted = replace_score(before.current, effect, score_below)
    step = SelectionStep(
        (), before.current, (), judged(Candidate(effect, (), 0.5), before.current, fitted, study.settings)
    )
    return replace(before.at(fitted), steps=(*before.steps, step))


def replace_score(fitted, effect, below):
    fits = tuple(replace(f, mean_square=f.mean_square * np.exp(-below)) for f in fitted.fits)
    return replace(fitted, effects=(*fitted.effects, effect), fits=fits)


def test_a_law_that_contains_the_one_found_goes_before_a_second_effect(motor, sticking) -> None:
    """Seen: Coulomb friction at a carriage, then Stribeck friction at the motor in place of Stribeck friction at the carriage."""
    study, before, fits, wide = sticking
    gained = before.current.score - fits[wide.prefix].score
    assert gained > 0.1
    second = attach(motor, "rotor", QuadraticDrag())
    found = flexed(study, before, after(study, before, second, 0.5 * gained))
    assert found is not None and found.current is fits[wide.prefix] and found.prefixes == {wide.prefix}
    (step,) = found.steps
    assert step.taken is not None and step.taken.candidate.attachment == wide
    assert flexed(study, before, after(study, before, second, 2.0 * gained)) is None, "the second effect goes farther"


def test_it_is_refitted_where_other_effects_came_since(motor, sticking) -> None:
    study, before, fits, wide = sticking
    gained = before.current.score - fits[wide.prefix].score
    ripple = attach(motor, "rotor", TorqueRipple(3.0))
    between = after(study, before, ripple, 0.0)
    second = attach(motor, "rotor", QuadraticDrag())
    found = flexed(study, between, after(study, between, second, 0.5 * gained))
    assert found is not None and found.prefixes == {wide.prefix, ripple.prefix}
    assert len(found.steps) == len(between.steps)


def test_where_nothing_was_taken_nothing_flexes(sticking) -> None:
    study, before, *_ = sticking
    idle = replace(before, steps=(*before.steps, SelectionStep((), before.current, (), None)))
    assert flexed(study, before, idle) is None


def test_a_law_that_is_there_itself_takes_no_other_place(motor, sticking) -> None:
    """Seen: Coulomb friction and bristles at an arm: the diagnosis ended with "'states' names arm.presliding_hysteresis.bristle twice"."""
    study, before, fits, wide = sticking
    assert list(wider_laws(study, before))
    both = before.at(replace(before.current, effects=(*before.effects, wide)))
    assert not list(wider_laws(study, both))
