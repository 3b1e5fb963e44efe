"""Stages after the search, interrupted: what was found before stands."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.deadline import Deadline, check_time
from greybox_torch.diagnosis import findings, selection
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


@pytest.mark.parametrize(
    ("left", "holds", "unknown", "stands"),
    [(0.1, True, False, True), (0.6, True, False, False), (0.1, False, False, False), (0.1, True, True, False)],
)
def test_where_time_ends_what_led_the_search_stands_if_free_runs_bear_it_out(
    monkeypatch, stub, left, holds, unknown, stands
) -> None:
    """Seen: 300 times the noise without a name, as four effects that came after the right statement were being taken back."""
    gain, ripple = stub(prefix="actuator.gain"), stub(prefix="motor.ripple")
    plain, alone, both = (stub(effects=e) for e in ((), (gain,), (gain, ripple)))
    steps = (
        stub(parent=plain, taken=stub(fitted=alone, unknown=unknown)),
        stub(parent=alone, taken=stub(fitted=both, unknown=False)),
    )
    judged = stub(
        having=lambda final, *_: stub(holds=holds, mismatch=lambda effects: left if effects else 1.0),
        without_effects=lambda: None,
    )
    monkeypatch.setattr(findings, "from_longest_windows", lambda hypothesis: hypothesis)
    monkeypatch.setattr(findings, "sound", lambda study, ranked: True)
    study = stub(settings=DiagnosisSettings())
    state, gains, _, _, whole = findings._found_first(study, SearchState(plain, both, steps), judged)
    assert state.current is (alone if stands else plain) and not gains and not whole
    assert findings._found_first(study, SearchState(plain, plain), judged)[0].current is plain


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
    monkeypatch.setattr(findings, "from_longest_windows", lambda hypothesis: hypothesis)
    monkeypatch.setattr(findings, "sound", lambda study, ranked: True)
    state = SearchState(plain, alone, (stub(parent=plain, taken=stub(fitted=alone, unknown=False)),))
    study = stub(settings=DiagnosisSettings(), working_on=lambda text: None)
    over = stub(
        study=study, state=state, others=None, gains={}, free_runs=None, schedule=Schedule(judging=Deadline(0.0))
    )
    found, _, _, _, whole = findings._judged(over, stub(), stub())
    assert found.current is alone and not whole
