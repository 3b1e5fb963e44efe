"""Searches after the first: what one more experiment to choose with shows, and what stands where that search is stopped."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from greybox_torch.deadline import TimeIsUp
from greybox_torch.diagnosis import further_searches
from greybox_torch.diagnosis.findings import Findings
from greybox_torch.diagnosis.further_searches import find_with_more
from greybox_torch.diagnosis.select.state import SearchState


@pytest.fixture
def first(stub) -> Findings:
    """A search that ended, on a data set of which one more experiment shows something."""

    def working_on(text: str) -> None:
        assert text.startswith("searching again, run 2")

    state = SearchState(stub(effects=()), stub(effects=()))
    study = stub(working_on=working_on)
    return Findings(stub(), study, state, state.current, stub(), {}, stub(), complete=True)


@pytest.mark.parametrize("stop", [KeyboardInterrupt, TimeIsUp])
@pytest.mark.parametrize("at", ["promote_validation", "find", "replaces"])
def test_while_searching_again_what_was_found_first_stands(monkeypatch, stub, first, at, stop) -> None:
    def stopped(*args: Any) -> Any:
        raise stop

    found_again = Findings(
        first.dataset,
        first.study,
        SearchState(stub(effects=()), stub(effects=(stub(),))),
        first.searched,
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
        monkeypatch.setattr(further_searches, name, stopped if name == at else step)
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
        monkeypatch.setattr(further_searches, name, step)
    assert find_with_more(found, stub(), stub(), stub()).state is found.state
    assert len(searches) == 1


def test_a_second_search_that_was_cut_short_and_serves_no_better_leaves_the_first_incomplete(
    monkeypatch, stub, first
) -> None:
    more = stub(taken="run 2", dataset=stub(), sentence=lambda: "run 2 was taken")
    state = SearchState(stub(effects=()), stub(effects=()))
    cut = Findings(first.dataset, first.study, state, state.current, None, {}, stub(), complete=False)
    monkeypatch.setattr(further_searches, "promote_validation", lambda *args: more)
    monkeypatch.setattr(further_searches, "find", lambda *args: cut)
    best = find_with_more(first, stub(), stub(), stub())
    assert best.state is first.state and not best.complete


def test_one_more_search_begins_from_all_that_was_found_before(monkeypatch, stub, first) -> None:
    searched, told = stub(effects=(stub(),)), []

    def find(dataset: Any, model: Any, make_study: Any, clock: Any, end: Any, found_before: Any) -> Findings:
        told.append(found_before)
        return replace(first, others=None)

    more = stub(taken="run 2", dataset=stub(), sentence=lambda: "run 2 was taken")
    monkeypatch.setattr(further_searches, "promote_validation", lambda *args: more)
    monkeypatch.setattr(further_searches, "find", find)
    find_with_more(replace(first, searched=searched), stub(), stub(), stub())
    assert told == [searched]
