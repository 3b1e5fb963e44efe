"""Two laws that draw a curve together are asked in its place."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import forward
from greybox_torch.diagnosis.select.forward import _named_instead
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.select.two_laws import second_step, with_first_of_two
from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.unknown import Unknown


def uneven(q: float, v: float) -> float:
    """Dry friction of 0.09 N m forwards and 0.03 N m backwards."""
    return -0.06 * np.tanh(v / 0.2) - 0.03 * np.tanh(v / 0.2) ** 2


@pytest.fixture(scope="module")
def drawn(motor_data, motor, begun):
    """Makes a search with friction of its own and its state after a step that took a curve over the speed."""

    def make(torque: Any) -> tuple[Any, SearchState]:
        search = begun(motor_data(torque=torque), motor)
        curve = attach(motor, "rotor", Unknown("speed", 24))
        begin = {f"{curve.prefix}.w_{k}": 0.02 * (1 if k < 12 else -1) for k in range(24)}
        fitted = search.refitted((curve,), search.plain, [search.plain.values() | begin])
        assert fitted.score < search.plain.score - 0.5
        taken = judged(Candidate(curve, (), 0.5), search.plain, fitted, search.study.settings)
        step = SelectionStep((), search.plain, (taken,), taken)
        return search, replace(search.state.at(fitted), steps=(step,))

    return make


@pytest.mark.parametrize(
    ("torque", "second", "parameter"),
    [
        (uneven, "coulomb_asymmetry", "delta"),
        (lambda q, v: -0.06 * np.tanh(v / 0.2) - 0.03, "constant_bias", "bias"),
    ],
)
def test_a_level_and_another_law_stand_for_the_curve(drawn, torque, second, parameter) -> None:
    """Seen: a winch's dry friction, three times as large in one direction, unknown at the drum."""
    search, with_curve = drawn(torque)
    state = result_of(_named_instead(search.study, search.state, with_curve))
    assert {e.mechanism.name for e in state.effects} == {"coulomb_friction", second}
    values = state.current.values()
    assert values["rotor.coulomb_friction.F_c"] == pytest.approx(0.06, rel=0.1)
    assert abs(values[f"rotor.{second}.{parameter}"]) == pytest.approx(0.03, rel=0.1)
    assert state.current.score < with_curve.current.score + 0.02
    assert state.found_before is None
    for effect in state.effects:  # each with its own step, beside its rivals
        step = state.step_of(effect.prefix)
        assert step is not None and step.taken is not None and len(step.ranked) >= 1
        assert set(step.taken.fitted.effects) - set(step.parent.effects) == {step.taken.candidate.attachment}


def test_not_where_one_law_does_or_no_effect_may_be_added(drawn) -> None:
    search, with_curve = drawn(lambda q, v: -0.06 * np.tanh(v / 0.2))
    assert with_first_of_two(search.study, search.state, with_curve) is None
    search, with_curve = drawn(uneven)
    first = with_first_of_two(search.study, search.state, with_curve)
    assert first is not None and len(first.effects) == 1 and first.found_before is not None
    assert len(first.found_before.effects) == 2 and first.steps[-1].taken.fitted is first.current
    few = replace(search.study, budget=replace(SearchBudget(), most_effects=1))
    assert with_first_of_two(few, search.state, with_curve) is None
    nothing = replace(with_curve, steps=(replace(with_curve.steps[0], taken=None),))
    assert with_first_of_two(search.study, search.state, nothing) is None


def test_two_that_do_not_come_as_far_as_the_curve_are_passed_over(drawn, monkeypatch) -> None:
    search, with_curve = drawn(uneven)
    monkeypatch.setattr(forward, "as_far_as_curve", lambda *_: False)
    monkeypatch.setattr(forward, "_without_curves", lambda *_: nothing(search.state))
    state = result_of(_named_instead(search.study, search.state, with_curve))
    assert state.effects == with_curve.effects


def nothing(state: SearchState) -> Any:
    """A branch that finds nothing."""
    yield state
    return state


def test_a_law_of_the_same_name_by_another_label_is_not_the_first_of_two(drawn) -> None:
    """Seen: a pan-tilt head on a spring: the step had a ripple of another order by the same name, and the diagnosis ended in an error."""
    search, with_curve = drawn(uneven)
    (step,) = with_curve.steps
    first = with_first_of_two(search.study, search.state, with_curve)
    assert first is not None
    own = first.steps[-1].taken
    assert own is not None
    labelled = replace(own.candidate.attachment, label="_2")
    other = judged(
        replace(own.candidate, attachment=labelled),
        search.plain,
        search.refitted((labelled,), search.plain),
        search.study.settings,
    )
    with_other = replace(with_curve, steps=(replace(step, ranked=(*step.ranked, other)),))
    again = with_first_of_two(search.study, search.state, with_other)
    assert again is not None and again.prefixes == first.prefixes
    assert {e.mechanism.name for e in result_of(second_step(search.study, again)).effects} == {
        "coulomb_friction",
        "coulomb_asymmetry",
    }
