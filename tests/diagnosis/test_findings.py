"""Stages after the search, interrupted: what was found before stands."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.deadline import Deadline, check_time
from greybox_torch.diagnosis import findings, selection
from greybox_torch.diagnosis.confirm import when_stopped
from greybox_torch.diagnosis.schedule import Schedule
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings


def test_confirmation_that_is_cut_short_leaves_what_it_had_reached(monkeypatch, stub) -> None:
    effect = stub(prefix="rotor.drag")
    before = SearchState(stub(effects=()), stub(effects=(effect,)), without={"rotor.drag": stub()})
    reached = SearchState(stub(effects=()), stub(effects=(effect,)), without={"rotor.drag": stub()})

    def confirming(*args: Any):
        yield reached
        raise KeyboardInterrupt

    monkeypatch.setattr(selection, "confirm", confirming)
    assert selection._confirmed(stub(), before, stub(), Deadline()) == (reached, {}, False)


def test_final_fits_that_are_cut_short_leave_the_values_of_the_windows(monkeypatch, stub) -> None:
    def working_on(text: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(findings, "from_longest_windows", lambda hypothesis: hypothesis)
    state = SearchState(stub(effects=()), stub(effects=(stub(),)))
    assert findings._finished(stub(working_on=working_on), state, Deadline()) == ((state.plain, state.current), False)


def test_what_led_the_search_is_judged_also_where_time_has_ended(monkeypatch, stub) -> None:
    """Seen: a diagnosis that was stopped while effects were taken back ended with an internal error, as free runs were stopped as well."""
    gain = stub(prefix="actuator.gain")
    plain, alone = stub(effects=()), stub(effects=(gain,))

    def having(final: Any, *_: Any) -> Any:
        check_time()
        return stub(holds=True, mismatch=lambda effects: 0.1 if effects else 1.0)

    def with_effects(*_: Any) -> Any:
        return stub(having=having, without_effects=lambda: None)

    def until_time_ends(*_: Any) -> None:
        check_time()

    monkeypatch.setattr(findings.Judgement, "of", lambda free_runs, final: stub(having=with_effects))
    monkeypatch.setattr(findings, "holding", until_time_ends)
    monkeypatch.setattr(when_stopped, "from_longest_windows", lambda hypothesis: hypothesis)
    monkeypatch.setattr(when_stopped, "sound", lambda study, ranked: True)
    taken = stub(fitted=alone, unknown=False, candidate=stub(attachment=gain))
    state = SearchState(plain, alone, (stub(parent=plain, taken=taken, ranked=()),))
    study = stub(settings=DiagnosisSettings(), working_on=lambda text: None)
    over = stub(
        study=study, state=state, others=None, gains={}, free_runs=None, schedule=Schedule(judging=Deadline(0.0))
    )
    found, _, _, _, whole = findings._judged(over, stub(), stub())
    assert found.current is alone and not whole


@pytest.mark.parametrize(
    ("searched", "lasted", "share_left", "has_curve", "asked"),
    [
        (("bath.flow", "bath.bias"), (), 1.0, False, True),
        (("bath.flow", "bath.bias"), ("bath.bias",), 0.12, False, True),
        (("bath.flow", "bath.bias"), ("bath.bias",), 0.02, False, False),
        (("bath.bias",), ("bath.bias",), 0.12, False, False),
        (("bath.unknown", "bath.bias"), ("bath.unknown",), 0.12, True, False),
    ],
    ids=["nothing lasted", "little lasted", "enough lasted", "all lasted", "a curve lasted"],
)
def test_a_curve_is_asked_where_little_of_the_names_lasted(
    stub, searched, lasted, share_left, has_curve, asked
) -> None:
    """Seen: what evaporates from a bath, told as a constant (0.74) with 28 times the noise; the curve over its temperature leaves 1.4."""
    before, state = (stub(effects=names, prefixes=set(names), has_curve=has_curve) for names in (searched, lasted))
    judged = stub(left=lambda effects: (share_left, 28.0), settings=DiagnosisSettings())
    assert findings._curve_is_asked(before, (state, {}, judged, (), True)) is asked


@pytest.mark.parametrize(
    ("small", "shown", "kept"), [(set(), set(), True), ({"curve"}, {"curve"}, True), ({"curve"}, set(), False)]
)
def test_refinements_alone_leave_the_model_as_it_stands(monkeypatch, stub, small, shown, kept) -> None:
    """Seen: uptake of glucose that saturates: over longer windows the same curve was a finding, and gave way to itself as a refinement."""
    monkeypatch.setattr(findings, "small_ones", lambda *_: {f"pool.{name}": "why" for name in small})
    monkeypatch.setattr(findings, "sizes", lambda *_: {})
    monkeypatch.setattr(findings, "shown_by_free_runs", lambda *_: shown)
    plain, curve = stub(effects=()), stub(effects=(stub(prefix="pool.curve"),))
    without = stub()
    found = _found(stub, SearchState(plain, curve), stub(without_effects=lambda: without))
    asked = findings.without_refinements_alone(found)
    assert (asked is found) is kept
    if not kept:
        assert asked.state.current is plain and asked.judged is without and asked.gains == {}
    nothing = _found(stub, SearchState(plain, plain), stub())
    assert findings.without_refinements_alone(nothing) is nothing


def _found(stub, state: SearchState, judged: Any) -> findings.Findings:
    named: dict[str, Any] = dict.fromkeys(("dataset", "study", "others", "free_runs", "schedule"), stub())
    return findings.Findings(**named, state=state, searched=state.current, gains={"pool.curve": stub()}, judged=judged)


@pytest.mark.parametrize(
    ("effects", "answers", "told"),
    [
        ((), {"curve_instead": None, "passed_over": "laws", "memory_instead": "memory"}, ("laws", ("why laws",))),
        ((), {"curve_instead": None, "passed_over": None, "memory_instead": "memory"}, ("memory", ())),
        ((), {"curve_instead": "curve", "passed_over": "laws", "memory_instead": "memory"}, ("curve", ())),
        (("bias",), {"curve_instead": None, "passed_over": "laws", "memory_instead": "memory"}, (None, ())),
    ],
    ids=["laws", "what remembers", "a curve, which laws may replace", "names that lasted"],
)
def test_where_nothing_lasted_laws_that_were_passed_over_are_asked(monkeypatch, stub, effects, answers, told) -> None:
    """Seen: a free pendulum's drag, passed over by windows (validation 88 %; with it 97 %): Stribeck friction was told (0.97)."""
    for name, answer in answers.items():
        monkeypatch.setattr(findings, name, lambda *_, answer=answer: answer)
    monkeypatch.setattr(findings, "chosen_by_free_runs", lambda standing, before, judged: f"why {standing}")
    found = (stub(effects=effects), {}, stub(), (), True)
    assert findings._instead(stub(), stub(), stub(), found) == (*told, True)
