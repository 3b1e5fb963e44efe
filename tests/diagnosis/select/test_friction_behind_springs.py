"""Dry friction of a light body behind a spring, told in front of it, is asked behind it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import friction_behind_springs as module
from greybox_torch.diagnosis.select.friction_behind_springs import friction_behind_springs
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction, QuadraticDrag
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State

STEP, STIFFNESS, LEVEL = 0.002, 60.0, 0.3


class Wiper(GreyBoxModel):
    """A motor, and a blade a tenth as heavy behind a spring. Only the motor's angle is measured."""

    states = [State("q_m", "rad"), State("q_b", "rad"), State("w_m", "rad/s"), State("w_b", "rad/s")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("q_m", "rad")]
    parameters = [
        Parameter("J_m", 0.01, "kg m^2", fixed=True),
        Parameter("J_b", 0.001, "kg m^2", fixed=True),
        Parameter("k", STIFFNESS, "N m/rad", lower=1e-3),
        Parameter("d", 0.02, "N m s/rad", fixed=True),
        Parameter("b", 0.05, "N m s/rad"),
    ]
    ports = [
        Body("motor", speed="w_m", position="q_m"),
        Body("blade", speed="w_b", position="q_b"),
        Coupling("arm", deflection=lambda x, u, p: x.q_m - x.q_b, rate=lambda x, u, p: x.w_m - x.w_b),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        carried = p.k * (x.q_m - x.q_b) + p.d * (x.w_m - x.w_b) + port.arm
        return {
            "q_m": x.w_m,
            "q_b": x.w_b,
            "w_m": (u.torque - carried - p.b * x.w_m + port.motor) / p.J_m,
            "w_b": (carried + port.blade) / p.J_b,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"q_m": x.q_m}


def with_a_blade_that_sticks(torque: np.ndarray, finer: int = 40) -> np.ndarray:
    """The motor's angle where set-valued friction holds the blade, in symplectic Euler steps: it sticks where less than that pushes it."""
    q_m, q_b, w_m, w_b, h, seen = 0.0, 0.0, 0.0, 0.0, STEP / finer, []
    for u in torque:
        seen.append(q_m)
        for _ in range(finer):
            carried = STIFFNESS * (q_m - q_b) + 0.02 * (w_m - w_b)
            w_m += h * (u - carried - 0.05 * w_m) / 0.01
            free = w_b + h * carried / 0.001
            w_b = np.sign(free) * max(abs(free) - h * LEVEL / 0.001, 0.0)
            q_m, q_b = q_m + h * w_m, q_b + h * w_b
    return np.array(seen)


@pytest.fixture(scope="module")
def told_at_the_motor(data_set, begun) -> tuple[Any, SearchState]:
    """A search, and its state after a step that took the blade's friction as bristles of the motor."""
    rng = np.random.default_rng(5)
    torque = np.repeat(rng.uniform(-0.8, 0.8, 40), 40)
    angle = with_a_blade_that_sticks(torque) + rng.normal(0, 2e-4, len(torque))
    units = {"torque": "N m", "q_m": "rad"}
    dataset = data_set(units, [{"torque": torque, "q_m": angle}], roles=["estimation"], sample_time=STEP)
    model = Wiper()
    search = begun(dataset, model, substeps=1)
    law = attach(model, "motor", PreslidingHysteresis())
    start = {**search.plain.values(), f"{law.prefix}.F": LEVEL, f"{law.prefix}.z_0": LEVEL / STIFFNESS}
    fitted = search.refitted((law,), search.plain, [start])
    taken = judged(Candidate(law, (), 0.5), search.plain, fitted, search.study.settings)
    assert taken.gain > 0.5
    return search, replace(search.state.at(fitted), steps=(SelectionStep((), search.plain, (taken,), taken),))


def ringing(search: Any, times: float) -> Any:
    """The study as if the blade had been so many ``times`` as fast in the model as it stands."""
    around = search.surroundings["blade"]
    speed = around.ranges["speed"]
    fast = Range(times * speed.low, times * speed.high, times * speed.rms)
    blade = replace(around, ranges={**around.ranges, "speed": fast})
    return replace(search.study, surroundings={**search.surroundings, "blade": blade})


def test_a_body_that_rang_in_the_model_as_it_stood_holds_what_was_told_in_front_of_it(told_at_the_motor) -> None:
    """Seen: the packing of a valve's plug, told as bristles at its actuator (0.85)."""
    search, state = told_at_the_motor
    found = friction_behind_springs(ringing(search, 30.0), state)
    assert found is not None
    study, after = found
    (law,) = after.effects
    assert law.named == ("blade", "coulomb_friction")
    assert law.own(after.current.values())["F_c"] == pytest.approx(LEVEL, rel=0.05)
    assert after.current.score < state.current.score - 0.5
    assert study.surroundings["blade"].ranges["speed"].reach < 30.0 * search.surroundings["blade"].ranges["speed"].reach
    ranked = [r.candidate.attachment.named for r in after.steps[0].ranked]
    assert {law.named, ("motor", "presliding_hysteresis")} <= set(ranked), "what was told is its rival"


def test_a_spring_far_from_the_card_gives_it_away(told_at_the_motor) -> None:
    """Seen: a wiper's blade, told as bristles at its motor (0.85), with an arm 300 times softer than on the card."""
    search, state = told_at_the_motor
    problem = search.study.problem

    def card(times: float) -> Any:
        k = problem.names.index("k")
        values = np.where(np.arange(len(problem.names)) == k, times * state.current.values()["k"], problem.values)
        return replace(search.study, problem=replace(problem, values=values))

    assert module._bent(card(40.0), state.current) and not module._bent(card(2.0), state.current)


def test_nothing_is_asked_where_nothing_speaks_for_it(told_at_the_motor, monkeypatch) -> None:
    search, state = told_at_the_motor
    monkeypatch.setattr(module, "fit", lambda *_: pytest.fail("a fit was asked for"))
    monkeypatch.setattr(module, "_bent", lambda *_: False)
    assert friction_behind_springs(ringing(search, 0.5), state) is None, "the blade is no slower, and no spring is soft"
    fast = ringing(search, 30.0)
    drag = attach(search.study.problem.model, "motor", QuadraticDrag())
    other = state.at(search.refitted((drag,), search.plain))
    assert friction_behind_springs(fast, other) is None, "not of a law that holds nothing"
    monkeypatch.setattr(module, "only_noise", lambda *_: True)
    assert friction_behind_springs(fast, state) is None


def test_what_goes_no_farther_behind_the_spring_stays(told_at_the_motor, monkeypatch) -> None:
    search, state = told_at_the_motor
    monkeypatch.setattr(module, "fit", lambda *_: None)
    assert friction_behind_springs(ringing(search, 30.0), state) is None


def test_a_law_that_is_there_already_is_not_asked_again(told_at_the_motor) -> None:
    """A body has one law of a name: with two a diagnosis ended with an error."""
    search, state = told_at_the_motor
    blade = attach(search.study.problem.model, "blade", CoulombFriction())
    first = search.refitted((blade,), search.plain)
    motor = state.effects[0]
    both = search.refitted((blade, motor), first, [{**first.values(), **state.current.values()}])
    steps = tuple(
        SelectionStep((), parent, (r,), r)
        for parent, law, fitted in ((search.plain, blade, first), (first, motor, both))
        for r in (judged(Candidate(law, (), 0.5), parent, fitted, search.study.settings),)
    )
    found = friction_behind_springs(ringing(search, 30.0), replace(search.state.at(both), steps=steps))
    if found is not None:
        names = [e.named for e in found[1].effects]
        assert len(names) == len(set(names))


def test_what_was_known_of_memory_stays_known(told_at_the_motor) -> None:
    search, state = told_at_the_motor
    known = replace(state, memory=state, in_place_of=state.steps[0])
    found = friction_behind_springs(ringing(search, 30.0), known)
    assert found is not None and found[1].memory is state and found[1].in_place_of is state.steps[0]


def test_each_law_stands_once_among_what_was_asked(told_at_the_motor) -> None:
    search, state = told_at_the_motor
    found = friction_behind_springs(ringing(search, 30.0), state)
    assert found is not None
    named = [r.candidate.attachment.named for r in found[1].steps[0].ranked]
    assert len(named) == len(set(named))
