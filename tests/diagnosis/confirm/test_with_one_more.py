"""A law that windows were not sure of, beside effects that free runs do not bear out without it."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.confirm import far_better
from greybox_torch.diagnosis.confirm import with_one_more as module
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.with_one_more import with_one_more
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings

SURE, CHANCE = Gain(0.9, 0.01, size=0.9), Gain(0.01, 0.01, size=0.01)


def hypothesis(stub, *laws: str):
    return stub(effects=tuple(stub(prefix=law, mechanism=stub(free=law == "curve")) for law in laws), score=1.0)


def candidate(stub, state: SearchState, law: str, gain: float = 0.2, completes: bool = True, sound: bool = True):
    fitted = stub(effects=(*state.effects, stub(prefix=law, mechanism=stub(free=False))), completes=completes)
    unknown, attachment = law == "curve", stub(prefix=law)
    return stub(unknown=unknown, gain=gain, fitted=fitted, sound=sound, candidate=stub(attachment=attachment))


@pytest.fixture
def study(stub, monkeypatch):
    monkeypatch.setattr(module, "sound", lambda study, ranked: ranked.sound)
    monkeypatch.setattr(module, "completes", lambda fitted, settings: fitted.completes)
    monkeypatch.setattr(module, "least_gain", lambda fitted, settings: 0.01)
    monkeypatch.setattr(module, "refitted", lambda study, rest, current: hypothesis(stub, *(e.prefix for e in rest)))
    monkeypatch.setattr(far_better, "finish", lambda hypothesis, *rest: hypothesis)
    monkeypatch.setattr(far_better, "held_out_gains", lambda state, others: dict.fromkeys(state.without, SURE))
    return stub(settings=DiagnosisSettings(), budget=None, recorded=None, working_on=lambda text: None)


@pytest.fixture
def drag(stub) -> SearchState:
    """A search that found drag."""
    return SearchState(hypothesis(stub), hypothesis(stub, "drag"))


def refusing(state: SearchState, *ranked) -> SearchState:
    """``state`` after a step that took none of these."""
    return SearchState(state.plain, state.current, (SelectionStep((), state.current, ranked, None),))


def judged(stub, left: float, then: float = 1.0, holds: bool = True):
    """Free runs that leave so much of the mismatch, and those with one more law."""
    after = stub(mismatch=lambda effects: then, holds=holds, unstable=())
    return stub(mismatch=lambda effects: left if effects else 1.0, having=lambda final, places: after)


def test_what_completes_the_model_is_asked_of_the_held_out_experiments(stub, study, drag) -> None:
    """Seen: a stage's drag (0.2 of the mismatch left, worse in one free run) and a small constant force: an unknown curve was told."""
    state = refusing(drag, candidate(stub, drag, "curve"), candidate(stub, drag, "bias"))
    found = with_one_more(study, state, stub(places=lambda h: {}, fits=lambda h: ()), judged(stub, 0.2, 0.005))
    assert found is not None
    more, gains, by_it = found
    assert more.prefixes == {"drag", "bias"} and gains == {"drag": SURE, "bias": SURE}
    assert more.without["bias"] is drag.current and {e.prefix for e in more.without["drag"].effects} == {"bias"}
    assert more.compared_without and by_it.mismatch(True) == 0.005
    step = more.step_of("bias")
    assert step is not None and step.taken is state.steps[-1].ranked[1]
    again = more.at(drag.current)
    assert (
        with_one_more(study, again, stub(places=lambda h: {}, fits=lambda h: ()), judged(stub, 0.2, 0.005)) is None
    ), "once"


@pytest.mark.parametrize("what", [{"gain": 0.0}, {"completes": False}, {"sound": False}])
def test_what_pays_nothing_completes_nothing_or_says_nothing_is_not_asked(stub, study, drag, what) -> None:
    state = refusing(drag, candidate(stub, drag, "bias", **what))
    assert with_one_more(study, state, stub(places=lambda h: {}, fits=lambda h: ()), judged(stub, 0.2, 0.005)) is None


def test_free_runs_and_windows_have_to_bear_it_out(stub, study, drag, monkeypatch) -> None:
    state, others = refusing(drag, candidate(stub, drag, "bias")), stub(places=lambda h: {}, fits=lambda h: ())
    assert with_one_more(study, state, None, judged(stub, 0.2, 0.005)) is None, "nothing is held out"
    assert with_one_more(study, state, others, judged(stub, 0.2, 0.15)) is None, "no far better"
    assert with_one_more(study, state, others, judged(stub, 3.0, 0.8)) is None, "no far better than without any effect"
    assert with_one_more(study, state, others, judged(stub, 0.2, 0.005, holds=False)) is None
    monkeypatch.setattr(far_better, "held_out_gains", lambda state, others: {"drag": SURE, "bias": CHANCE})
    assert with_one_more(study, state, others, judged(stub, 0.2, 0.005)) is None


def test_only_beside_the_effects_that_are_left_and_none_beside_a_curve(stub, study, drag) -> None:
    others, free = stub(places=lambda h: {}, fits=lambda h: ()), judged(stub, 0.2, 0.005)
    before = refusing(SearchState(drag.plain, drag.plain), candidate(stub, drag, "bias"))
    assert with_one_more(study, before.at(drag.current), others, free) is None, "that step had no drag"
    curve = SearchState(drag.plain, hypothesis(stub, "curve"))
    assert with_one_more(study, refusing(curve, candidate(stub, curve, "bias")), others, free) is None
