"""Stages after the search, interrupted: what was found before stands."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from greybox_torch.deadline import Deadline, TimeIsUp
from greybox_torch.diagnosis import findings
from greybox_torch.diagnosis.findings import Findings, find_with_more
from greybox_torch.diagnosis.select.state import SearchState


@pytest.fixture
def first(stub) -> Findings:
    """A search that ended, on a data set of which one more experiment shows something."""

    def working_on(text: str) -> None:
        assert text.startswith("searching again, run 2")

    state = SearchState(stub(effects=()), stub(effects=()))
    study = stub(working_on=working_on)
    return Findings(stub(), study, state, stub(), {}, stub(), complete=True)


@pytest.mark.parametrize("stop", [KeyboardInterrupt, TimeIsUp])
@pytest.mark.parametrize("at", ["promote_validation", "find", "replaces"])
def test_while_searching_again_what_was_found_first_stands(monkeypatch, stub, first, at, stop) -> None:
    def stopped(*args: Any) -> Any:
        raise stop

    found_again = Findings(
        first.dataset,
        first.study,
        SearchState(stub(effects=()), stub(effects=(stub(),))),
        first.others,
        {},
        stub(),
        True,
    )
    more = stub(taken="run 2", dataset=stub(), sentence=lambda: "run 2 was taken")
    steps: dict[str, Any] = {
        "promote_validation": lambda *args: more,
        "find": lambda *args: found_again,
        "replaces": lambda *args: True,
    }
    for name, step in steps.items():
        monkeypatch.setattr(findings, name, stopped if name == at else step)
    best = find_with_more(first, stub(), stub(), stub())
    assert best.state is first.state and not best.complete


def test_what_one_more_experiment_does_not_better_is_not_searched_a_third_time(monkeypatch, stub, first) -> None:
    searches = []
    found = replace(first, state=SearchState(stub(effects=()), stub(effects=(stub(),))))

    def find(*args: Any) -> Findings:
        searches.append(args)
        return found

    more = stub(taken="run 2", dataset=stub(), sentence=lambda: "run 2 was taken")
    for name, step in {"promote_validation": lambda *a: more, "find": find, "replaces": lambda *a: False}.items():
        monkeypatch.setattr(findings, name, step)
    assert find_with_more(found, stub(), stub(), stub()).state is found.state
    assert len(searches) == 1


def test_a_second_search_that_was_cut_short_and_serves_no_better_leaves_the_first_incomplete(
    monkeypatch, stub, first
) -> None:
    more = stub(taken="run 2", dataset=stub(), sentence=lambda: "run 2 was taken")
    state = SearchState(stub(effects=()), stub(effects=()))
    cut = Findings(first.dataset, first.study, state, None, {}, stub(), complete=False)
    monkeypatch.setattr(findings, "promote_validation", lambda *args: more)
    monkeypatch.setattr(findings, "find", lambda *args: cut)
    best = find_with_more(first, stub(), stub(), stub())
    assert best.state is first.state and not best.complete


def test_confirmation_that_is_cut_short_leaves_what_it_had_reached(monkeypatch, stub) -> None:
    effect = stub(prefix="rotor.drag")
    before = SearchState(stub(effects=()), stub(effects=(effect,)), without={"rotor.drag": stub()})
    reached = SearchState(stub(effects=()), stub(effects=(effect,)), without={"rotor.drag": stub()})

    def confirming(*args: Any):
        yield reached
        raise KeyboardInterrupt

    monkeypatch.setattr(findings, "confirm", confirming)
    assert findings._confirmed(stub(), before, stub(), Deadline()) == (reached, {}, False)


def test_final_fits_that_are_cut_short_leave_the_values_of_the_windows(monkeypatch, stub) -> None:
    def working_on(text: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(findings, "from_longest_windows", lambda hypothesis: hypothesis)
    state = SearchState(stub(effects=()), stub(effects=(stub(),)))
    assert findings._finished(stub(working_on=working_on), state, Deadline()) == ((state.plain, state.current), False)
