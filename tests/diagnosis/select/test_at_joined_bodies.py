"""A law of one body is asked at the bodies that springs join with it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import at_joined_bodies as module
from greybox_torch.diagnosis.select.at_joined_bodies import at_joined_bodies
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import QuadraticDrag
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
from tests.diagnosis.by_runge_kutta import by_runge_kutta

STEP = 0.01


class TwoInertias(GreyBoxModel):
    """A motor and a load on a shaft that twists."""

    states = [State("q_m", "rad"), State("q_l", "rad"), State("w_m", "rad/s"), State("w_l", "rad/s")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("w_m", "rad/s")]
    parameters = [
        Parameter("J_m", 0.02, "kg m^2"),
        Parameter("J_l", 0.03, "kg m^2", fixed=True),
        Parameter("k", 3.0, "N m/rad"),
        Parameter("d", 0.02, "N m s/rad"),
        Parameter("b", 0.05, "N m s/rad", fixed=True),
    ]
    ports = [
        Body("motor", speed="w_m", position="q_m"),
        Body("load", speed="w_l", position="q_l"),
        Coupling("shaft", deflection=lambda x, u, p: x.q_m - x.q_l, rate=lambda x, u, p: x.w_m - x.w_l),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        carried = p.k * (x.q_m - x.q_l) + p.d * (x.w_m - x.w_l) + port.shaft
        return {
            "q_m": x.w_m,
            "q_l": x.w_l,
            "w_m": (u.torque - carried - p.b * x.w_m + port.motor) / p.J_m,
            "w_l": (carried + port.load) / p.J_l,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"w_m": x.w_m}


def with_drag_at_the_load(torque: np.ndarray, drag: float = 0.02, substeps: int = 10) -> np.ndarray:
    """The motor's speed, by Runge-Kutta steps, where the load meets a drag that grows with the square of its speed."""

    def rate(x: np.ndarray, u: float) -> np.ndarray:
        carried = 3.0 * (x[0] - x[1]) + 0.02 * (x[2] - x[3])
        accelerations = (u - carried - 0.05 * x[2]) / 0.02, (carried - drag * x[3] * abs(x[3])) / 0.03
        return np.array([x[2], x[3], *accelerations])

    return by_runge_kutta(rate, np.zeros(4), torque, STEP, substeps)[:, 2]


@pytest.fixture(scope="module")
def told_at_the_motor(data_set, begun) -> tuple[Any, SearchState]:
    """A search, and its state after a step that took the load's drag as one of the motor."""
    rng = np.random.default_rng(3)
    torque = np.repeat(rng.uniform(-1.5, 1.5, 60), 25)
    speed = with_drag_at_the_load(torque) + rng.normal(0, 0.01, len(torque))
    units = {"torque": "N m", "w_m": "rad/s"}
    dataset = data_set(units, [{"torque": torque, "w_m": speed}], roles=["estimation"], sample_time=STEP)
    model = TwoInertias()
    search = begun(dataset, model, substeps=4)
    law = attach(model, "motor", QuadraticDrag())
    fitted = search.refitted((law,), search.plain)
    taken = judged(Candidate(law, (), 0.5), search.plain, fitted, search.study.settings)
    assert taken.gain > 0.5
    step = SelectionStep((), search.plain, (taken,), taken)
    return search, replace(search.state.at(fitted), steps=(step,))


def test_what_goes_farther_at_the_other_end_of_a_spring_is_told_there(told_at_the_motor) -> None:
    """Seen: a stop of an arm, told as one of its gearbox, and what that left as a spring that stiffens (0.97 each)."""
    search, state = told_at_the_motor
    after = at_joined_bodies(search.study, state)
    assert [e.named for e in after.effects] == [("load", "quadratic_drag")]
    assert after.current.values()["load.quadratic_drag.c"] == pytest.approx(0.02, rel=0.05)
    (step,) = after.steps
    assert step.taken is not None and step.taken.fitted is after.current
    assert [r.candidate.attachment.port for r in step.ranked] == ["load", "motor"], "each is the other's rival"


def test_what_a_moved_law_contains_is_asked_there_too(told_at_the_motor, monkeypatch) -> None:
    """Seen: the dry friction of an arm, told as presliding at its gearbox (0.85)."""
    search, state = told_at_the_motor
    monkeypatch.setattr(QuadraticDrag, "generalises", ("viscous_friction",))
    (step,) = at_joined_bodies(search.study, state).steps
    asked = [r.candidate.attachment.named for r in step.ranked]
    assert ("load", "viscous_friction") in asked and ("motor", "viscous_friction") not in asked
    assert step.taken is not None and step.taken.candidate.attachment.named == ("load", "quadratic_drag")


def test_what_goes_no_farther_there_is_a_rival(told_at_the_motor, monkeypatch) -> None:
    search, state = told_at_the_motor
    monkeypatch.setattr(module, "only_noise", lambda *_: False)
    at_load = at_joined_bodies(search.study, state)
    step = at_load.steps[0]
    alone = replace(at_load, steps=(replace(step, ranked=step.ranked[:1]),))
    after = at_joined_bodies(search.study, alone)
    assert after.effects == at_load.effects and after.current is at_load.current
    assert [r.candidate.attachment.port for r in after.steps[0].ranked] == ["load", "motor"]


def test_asked_only_of_a_law_that_leaves_more_than_noise_and_had_no_turn_elsewhere(
    told_at_the_motor, monkeypatch
) -> None:
    search, state = told_at_the_motor
    monkeypatch.setattr(module, "fit", lambda *a, **k: pytest.fail("nothing is to be refitted"))
    (step,) = state.steps
    both = replace(state, steps=(at_turn_of_both(search, step),))
    assert at_joined_bodies(search.study, both) is both
    law = attach(search.study.problem.model, "load", QuadraticDrag())
    there_already = replace(state, steps=(replace(step, parent=search.refitted((law,), search.plain)),))
    assert at_joined_bodies(search.study, there_already) is there_already, "its parameters would be there twice"
    nothing = replace(state, steps=(replace(step, taken=None),))
    assert at_joined_bodies(search.study, nothing) is nothing
    curve = replace(step.taken.candidate, attachment=attach(search.study.problem.model, "motor", Unknown("speed", 8)))
    unknown = replace(state, steps=(replace(step, taken=replace(step.taken, candidate=curve)),))
    assert at_joined_bodies(search.study, unknown) is unknown
    monkeypatch.setattr(module, "only_noise", lambda *_: True)
    assert at_joined_bodies(search.study, state) is state


def test_asked_again_where_its_own_turn_ended_far_behind(told_at_the_motor) -> None:
    """Seen: a stop of an arm, told as one of its gearbox (0.97): by itself the arm's had ended in a local minimum."""
    search, state = told_at_the_motor
    step = at_turn_of_both(search, state.steps[0])
    poor = replace(step.ranked[1], fitted=search.plain, gain=0.0)  # as if its refit had not moved
    step = replace(step, ranked=(step.ranked[0], poor))
    after = at_joined_bodies(search.study, replace(state, steps=(step,)))
    assert [e.named for e in after.effects] == [("load", "quadratic_drag")]
    assert [r.candidate.attachment.port for r in after.steps[0].ranked] == ["load", "motor"], "each law once"


def test_what_goes_no_farther_than_by_itself_keeps_its_own_refit(told_at_the_motor, monkeypatch) -> None:
    search, state = told_at_the_motor
    step = at_turn_of_both(search, state.steps[0])
    own = replace(step.ranked[1], fitted=search.plain, gain=0.0)
    monkeypatch.setattr(module, "fit", lambda *a, **k: search.plain)
    monkeypatch.setattr(module, "polished", lambda study, fitted, starts: fitted)
    asked = replace(state, steps=(replace(step, ranked=(step.ranked[0], own)),))
    assert at_joined_bodies(search.study, asked) is asked


def test_a_law_in_finer_steps_is_refitted_in_them_and_is_its_own_rival_once(told_at_the_motor, monkeypatch) -> None:
    search, state = told_at_the_motor
    finer = replace(
        state.current, fits=state.current.fits
    )  # as after `in_finer_steps`: the step still has the one before
    refitted = []

    def further(study: Any, fitted: Any, starts: Any) -> Any:
        refitted.append(fitted)
        return replace(fitted)

    at_load = search.refitted((attach(search.study.problem.model, "load", QuadraticDrag()),), search.plain)
    monkeypatch.setattr(module, "fit", lambda *a, **k: at_load)
    monkeypatch.setattr(module, "polished", further)
    after = at_joined_bodies(search.study, state.at(finer))
    assert any(fitted is finer for fitted in refitted)
    assert sorted(r.candidate.attachment.port for r in after.steps[0].ranked) == ["load", "motor"]


@pytest.mark.parametrize(("better", "refits"), [(0.1, "most"), (0.0, 1)])
def test_refits_end_where_they_hardly_better_a_law(stub, monkeypatch, better, refits) -> None:
    asked = []
    monkeypatch.setattr(
        module,
        "polished",
        lambda study, fitted, starts: asked.append(0) or stub(score=fitted.score - better, values=dict),
    )
    study = stub(budget=stub(most_polishes=4), settings=stub(hardly_better=0.001), card={})
    module.converged(study, stub(score=1.0, values=dict))
    assert len(asked) == (4 if refits == "most" else refits)


def at_turn_of_both(search: Any, step: SelectionStep) -> SelectionStep:
    """The step with the law at the load among those that had a turn in it."""
    law = attach(search.study.problem.model, "load", QuadraticDrag())
    return replace(
        step,
        ranked=(*step.ranked, replace(step.ranked[0], candidate=replace(step.ranked[0].candidate, attachment=law))),
    )
