"""What was found, estimated from one more experiment in the place of another search."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.screen.candidates import attach
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import same_effects
from greybox_torch.diagnosis.select import search as module
from greybox_torch.diagnosis.select.same_effects import with_same_effects
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.unknown import Unknown


@pytest.fixture
def with_one_more(motor_data, motor, begun, dead_zone_search):
    """The search with both experiments of the motor with the dead zone, and how an effect was fitted to the first alone."""
    data = motor_data(acting=dead_zone)
    both = begun(replace(data, recordings=tuple(replace(r, role="estimation") for r in data.recordings)), motor)

    def make(port: str, law) -> tuple:
        effect = attach(motor, port, law)
        sizes = {f"{effect.prefix}.{name}": 0.1 for name in law.amplitudes(both.surroundings[port])}
        start = {**dead_zone_search.plain.values(), **sizes}
        fitted = dead_zone_search.refitted((effect,), dead_zone_search.plain, [start])
        return both, SearchState(dead_zone_search.plain, fitted)

    return make


def dead_zone(v):
    return v.clip(max=-0.5) + 0.5 + v.clip(min=0.5) - 0.5


def without_signal(found, signal: str):
    """The study of experiments that do not have a signal."""
    ranges = {q: {n: r for n, r in a.ranges.items() if n != signal} for q, a in found.surroundings.items()}
    bare = {q: replace(a, ranges=ranges[q]) for q, a in found.surroundings.items()}
    return replace(found.study, surroundings=bare)


@pytest.mark.parametrize("law", [ActuatorDeadzone(), Unknown("input", 28)])
def test_what_leaves_less_than_a_finding_is_kept_and_estimated_from_both(with_one_more, law, monkeypatch) -> None:
    """Seen: an arm's gear error and a bump in another's friction, searched anew for half a minute to come to the same."""
    both, before = with_one_more("actuator", law)
    monkeypatch.setattr(module, "explore", None)
    state = result_of(search(both.study, both.state, before))
    assert state.prefixes == before.prefixes and state.compared_without and state.plain is both.state.plain
    assert len(state.current.problem.records.first) == 2 and state.steps == before.steps
    if not law.free:
        (half_width,) = (v for name, v in state.current.values().items() if name.endswith("half_width"))
        assert half_width == pytest.approx(0.5, rel=0.02)


def test_what_leaves_more_is_searched_anew(with_one_more) -> None:
    both, before = with_one_more("rotor", ConstantBias())
    assert with_same_effects(both.study, both.state, before) is both.state


def test_a_curve_of_a_signal_that_one_more_experiment_does_not_have_is_searched_anew(with_one_more) -> None:
    both, before = with_one_more("actuator", Unknown("input", 28))
    assert with_same_effects(without_signal(both, "input"), both.state, before) is both.state


def test_a_rival_of_a_signal_that_one_more_experiment_does_not_have_is_not_asked(
    with_one_more, stub, monkeypatch
) -> None:
    both, before = with_one_more("actuator", ActuatorDeadzone())
    (zone,) = before.effects
    curve = attach(both.state.plain.model, "rotor", Unknown("along@voltage", 14, "direction@rotor"))
    ranked = [RankedCandidate(Candidate(e, ({},), 1.0), before.current, 1.0, 9.0) for e in (zone, curve)]
    asked: list = []
    monkeypatch.setattr(same_effects, "undecided", lambda *given: True)
    monkeypatch.setattr(same_effects, "listed", lambda *given: ranked[1:])
    monkeypatch.setattr(
        same_effects, "rank", lambda study, parent, offered: asked.extend(c.attachment for c in offered)
    )
    monkeypatch.setattr(same_effects, "take_best", lambda *given: iter([both.state]))
    monkeypatch.setattr(same_effects, "result_of", lambda stage: stub(took_one=False))
    step = stub(taken=ranked[0], screened=(), ranked=ranked)
    monkeypatch.setattr(SearchState, "step_of", lambda self, prefix: step)
    with_same_effects(without_signal(both, "along@voltage"), both.state, before)
    assert asked == [zone]
