"""The rivals of a law that was taken in a richer form are refitted from where that ended."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import RankedCandidate, judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.rivals_of_form import with_rivals_of_form
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombAsymmetry, CoulombFriction, QuadraticDrag


@dataclass(frozen=True)
class Elsewhere:
    """A hypothesis that ended in another valley: with poor values, hardly better than the model as it stands."""

    problem: Any
    poor: dict[str, float]
    score: float

    def values(self) -> dict[str, float]:
        return self.poor


@pytest.fixture
def after_form(motor_data, motor, begun):
    """The state after a step that took uneven friction of a motor with Coulomb friction of 0.06 N m; its rivals had ended elsewhere."""

    def make(*rivals: Attachment, torque: Any = lambda q, v: -0.06 * np.tanh(v / 0.2)) -> tuple[Any, SearchState]:
        search = begun(motor_data(torque=torque), motor)
        settings, plain = search.study.settings, search.plain
        law = attach(motor, "rotor", CoulombAsymmetry(with_level=True))
        start = {f"{law.prefix}.F_c": 0.06, f"{law.prefix}.delta": 0.01, f"{law.prefix}.v_0": 0.2}
        fitted = search.refitted((law,), plain, [plain.values() | start])
        form = judged(Candidate(law, (), 0.5), plain, fitted, settings)
        ranked = []
        for rival in rivals:
            problem = search.refitted((rival,), plain).problem
            poor = dict.fromkeys(problem.free_names, 0.05) | plain.values()
            ranked.append(
                RankedCandidate(Candidate(rival, (), 0.1), Elsewhere(problem, poor, plain.score - 0.01), 0.01, 0.5)
            )  # type: ignore[arg-type]
        step = SelectionStep((), plain, tuple(ranked), form)
        return search, replace(search.state.at(fitted), steps=(step,))

    return make


def test_a_rival_that_goes_farther_from_there_is_taken(after_form, motor) -> None:
    """Seen: play in a gear, told as a stiffness that differs by direction (0.97)."""
    dry, drag = attach(motor, "rotor", CoulombFriction()), attach(motor, "rotor", QuadraticDrag())
    search, state = after_form(drag, dry)
    after = with_rivals_of_form(search.study, state)
    assert after.effects == (dry,)
    assert after.current.values()[f"{dry.prefix}.F_c"] == pytest.approx(0.06, rel=0.05)
    (step,) = after.steps
    assert step.taken is not None and step.taken.fitted is after.current
    names = [r.candidate.attachment.mechanism.name for r in step.ranked]
    assert set(names) == {"coulomb_friction", "coulomb_asymmetry", "quadratic_drag"}, "the form is a rival now"
    assert min(r.gain for r in step.ranked) > 0.0


def test_the_form_stays_where_no_rival_goes_as_far_and_has_them_as_they_are_from_there(after_form, motor) -> None:
    dry = attach(motor, "rotor", CoulombFriction())
    search, state = after_form(dry, torque=lambda q, v: -0.06 * np.tanh(v / 0.2) - 0.03 * np.tanh(v / 0.2) ** 2)
    before = state.steps[-1].ranked[0]
    after = with_rivals_of_form(search.study, state)
    assert after.effects == state.effects and after.current is state.current
    (rival,) = after.steps[-1].ranked
    assert rival.fitted.score < before.fitted.score and rival.gain > before.gain


def test_nothing_is_asked_where_there_is_no_rival_or_another_effect_beside(after_form, motor) -> None:
    search, state = after_form()
    assert with_rivals_of_form(search.study, state) is state
    search, state = after_form(attach(motor, "rotor", CoulombFriction()))
    beside = search.refitted((*state.effects, attach(motor, "rotor", ConstantBias())), state.current)
    assert (two := state.at(beside)) and with_rivals_of_form(search.study, two) is two
    nothing = replace(state, steps=(replace(state.steps[0], taken=None),))
    assert with_rivals_of_form(search.study, nothing) is nothing
