"""Stages after the search, interrupted: what was found before stands."""

from __future__ import annotations

from typing import Any

from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis import findings, selection
from greybox_torch.diagnosis.select.state import SearchState


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
