"""One law told as two that do as well and have no more parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import as_two_laws as module
from greybox_torch.diagnosis.select.as_two_laws import as_two_laws, two_in_its_place
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction


def uneven(q: float, v: float) -> float:
    """Dry friction of 0.09 N m forwards and 0.03 N m backwards."""
    return -0.06 * np.tanh(v / 0.2) - 0.03 * np.tanh(v / 0.2) ** 2


def with_offset(q: float, v: float) -> float:
    """Dry friction of 0.06 N m, and a torque of −0.03 N m whatever the speed."""
    return -0.06 * np.tanh(v / 0.2) - 0.03


@pytest.fixture(scope="module")
def told_as_one(motor_data, motor, begun) -> Callable[[Any], tuple[Any, SearchState]]:
    """Makes a search with friction of its own and its state after a step that took uneven friction with a mean level."""

    def make(torque: Any) -> tuple[Any, SearchState]:
        search = begun(motor_data(torque=torque), motor)
        law = attach(motor, "rotor", CoulombAsymmetry(with_level=True))
        begin = {f"{law.prefix}.F_c": 0.06, f"{law.prefix}.delta": 0.03, f"{law.prefix}.v_0": 0.2}
        fitted = search.refitted((law,), search.plain, [search.plain.values() | begin])
        taken = judged(Candidate(law, (), 0.5), search.plain, fitted, search.study.settings)
        step = SelectionStep((), search.plain, (taken,), taken)
        return search, replace(search.state.at(fitted), steps=(step,))

    return make


def test_dry_friction_and_an_offset_are_two_laws_each_with_its_step(told_as_one) -> None:
    """Seen: a pendulum's motor with an offset and dry friction at its pivot, told as friction that differs by direction (0.97)."""
    search, one = told_as_one(with_offset)
    two = result_of(as_two_laws(search.study, search.state, one))
    assert "coulomb_friction" in {e.mechanism.name for e in two.effects} and len(two.effects) == 2
    values = two.current.values()
    assert values["rotor.coulomb_friction.F_c"] == pytest.approx(0.06, rel=0.1)
    named = {r.candidate.attachment.named for r in two.steps[-1].ranked}
    assert named & {("rotor", "constant_bias"), ("motor", "input_bias")}
    assert two.found_before is None and len(two.steps) == 2
    for effect in two.effects:
        step = two.step_of(effect.prefix)
        assert step is not None and step.taken is not None
        assert set(step.taken.fitted.effects) - set(step.parent.effects) == {step.taken.candidate.attachment}


def test_uneven_friction_stays_one_law_where_recordings_tell(told_as_one) -> None:
    search, one = told_as_one(uneven)
    assert two_in_its_place(search.study, one.current, one.effects[0]) is None
    assert result_of(as_two_laws(search.study, search.state, one)) is one


@pytest.mark.parametrize(
    ("says", "answer"), [("needed_by_likelihood", True), ("overall_significance", 15.0)], ids=["likelihood", "windows"]
)
def test_windows_and_likelihood_tell_where_the_scores_tie(told_as_one, monkeypatch, says, answer) -> None:
    """Seen: an excavator's boom, 420 N m up and 120 N m down, whose scores differ by 0.015, 15 standard errors."""
    search, one = told_as_one(with_offset)
    monkeypatch.setattr(module, says, lambda two, one, settings: answer)
    assert two_in_its_place(search.study, one.current, one.effects[0]) is None


def test_not_where_no_effect_may_be_added_nor_where_a_part_is_excluded(told_as_one, monkeypatch) -> None:
    search, one = told_as_one(with_offset)
    few = replace(search.study, budget=replace(SearchBudget(), most_effects=1))
    assert result_of(as_two_laws(few, search.state, one)) is one
    nothing = replace(one, steps=(replace(one.steps[0], taken=None),))
    assert result_of(as_two_laws(search.study, search.state, nothing)) is nothing
    believed = replace(search.study, beliefs=Excluding("constant_bias"))
    assert two_in_its_place(believed, one.current, one.effects[0]) is None


def test_not_beside_one_of_the_two(told_as_one, motor) -> None:
    search, one = told_as_one(with_offset)
    bias = attach(motor, "rotor", ConstantBias())
    beside = search.refitted((*one.effects, bias), one.current)
    assert two_in_its_place(search.study, beside, one.effects[0]) is None, "its parameters would be there twice"


def test_other_laws_are_not_two(told_as_one, motor) -> None:
    search, one = told_as_one(with_offset)
    dry = attach(motor, "rotor", CoulombFriction())
    assert two_in_its_place(search.study, one.current, dry) is None


class Excluding:
    """Beliefs that exclude one mechanism wherever it is."""

    def __init__(self, name: str) -> None:
        self.name = name

    def exclude(self, law: Any) -> bool:
        return law.mechanism.name == self.name
