"""Searches after the first: what one more experiment to choose with shows, and what stands where that search is stopped."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greybox_torch.deadline import Deadline, TimeIsUp
from greybox_torch.diagnosis import further_searches
from greybox_torch.diagnosis.findings import Findings
from greybox_torch.diagnosis.further_searches import find_with_more
from greybox_torch.diagnosis.schedule import Schedule
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.selection import Selection

PLACES = further_searches._places


@pytest.fixture(autouse=True)
def nothing_else_is_asked(monkeypatch) -> None:
    monkeypatch.setattr(further_searches, "_places", lambda last, others: {})
    for why in ("part", "doubtful", "for_a_curve", "for_a_rival", "to_tell_apart"):
        monkeypatch.setattr(further_searches, f"promote_{why}", lambda *args: None)


@pytest.fixture
def first(stub, monkeypatch) -> Selection:
    """A search that ended, on a data set of which one more experiment shows something."""

    def working_on(text: str) -> None:
        assert text.startswith("searching again, run 2")

    monkeypatch.setattr(further_searches, "judge", judged)
    state = SearchState(stub(effects=()), stub(effects=()))
    study, dataset = (
        stub(working_on=working_on, settings=stub(most_promoted=1)),
        stub(estimation=lambda: [stub(name="run 1")]),
    )
    return selection(state, dataset, study, stub())


def selection(state: SearchState, dataset: Any, study: Any, others: Any) -> Selection:
    return Selection(
        dataset=dataset,
        study=study,
        state=state,
        searched=state.current,
        others=others,
        gains={},
        free_runs=others,
        schedule=Schedule(),
    )


def judged(selection: Selection, clock: Any) -> Findings:
    """Everything is borne out, whatever the clock."""
    runs: Any = SimpleNamespace(unstable=frozenset(), refused_in="")
    return Findings(**{f.name: getattr(selection, f.name) for f in fields(Selection)}, judged=runs)


@pytest.fixture
def more(stub) -> Any:
    """What is taken to choose with as well."""
    both = stub(estimation=lambda: [stub(name="run 1"), stub(name="run 2")])
    return stub(taken="run 2", dataset=both, sentence=lambda: "run 2 was taken", same_effects=False)


@pytest.mark.parametrize("stop", [KeyboardInterrupt, TimeIsUp])
@pytest.mark.parametrize("at", ["promote_validation", "find", "replaces"])
def test_while_searching_again_what_was_found_first_stands(monkeypatch, stub, first, more, at, stop) -> None:
    def stopped(*args: Any, **named: Any) -> Any:
        raise stop

    found_again = replace(first, state=SearchState(stub(effects=()), stub(effects=(stub(),))), dataset=more.dataset)
    steps: dict[str, Any] = {
        "promote_validation": lambda *args: more,
        "find": lambda *args, **named: found_again,
        "replaces": lambda *args: True,
    }
    for name, step in steps.items():
        monkeypatch.setattr(further_searches, name, stopped if name == at else step)
    best = find_with_more(first, stub(), stub(), stub())
    assert best.state is first.state and not best.complete and best.others is None


def test_what_one_more_experiment_does_not_better_is_not_searched_a_third_time(monkeypatch, stub, first, more) -> None:
    searches = []
    found = replace(first, state=SearchState(stub(effects=()), stub(effects=(stub(),))))

    def find(*args: Any, **named: Any) -> Selection:
        searches.append(args)
        return replace(found, dataset=more.dataset)

    for name, step in {"promote_validation": lambda *a: more, "find": find, "replaces": lambda *a: False}.items():
        monkeypatch.setattr(further_searches, name, step)
    assert find_with_more(found, stub(), stub(), stub()).state is found.state
    assert len(searches) == 1


def test_a_second_search_that_was_cut_short_and_serves_no_better_leaves_the_first_incomplete(
    monkeypatch, stub, first, more
) -> None:
    state = SearchState(stub(effects=()), stub(effects=()))
    cut = replace(first, state=state, dataset=more.dataset, others=None, complete=False)
    monkeypatch.setattr(further_searches, "promote_validation", lambda *args: more)
    monkeypatch.setattr(further_searches, "find", lambda *args, **named: cut)
    best = find_with_more(first, stub(), stub(), stub())
    assert best.state is first.state and not best.complete and best.others is first.others


def test_free_runs_judge_what_is_selected_in_the_end_alone(monkeypatch, stub, first, more) -> None:
    better, asked = replace(first, state=SearchState(stub(effects=()), stub(effects=(stub(),)))), []

    def judge(selection: Selection, clock: Any) -> Findings:
        asked.append(selection.state)
        return judged(selection, clock)

    again = replace(better, dataset=more.dataset)
    steps: dict[str, Any] = {
        "promote_validation": lambda study, dataset, *a: more if dataset is first.dataset else None,
        "find": lambda *args, **named: again,
        "replaces": lambda *args: True,
        "judge": judge,
    }
    for name, step in steps.items():
        monkeypatch.setattr(further_searches, name, step)
    assert find_with_more(first, stub(), stub(), stub()).state is again.state
    assert asked == [again.state]
    asked.clear()
    find_with_more(first, stub(), stub(), stub(), Deadline.after(60.0))
    assert asked == [first.state, again.state], "where time is limited an answer stands before the next search"


def test_what_free_runs_take_back_is_selected_once_more_with_that_known(monkeypatch, stub, first, more) -> None:
    wrong, plain = (
        SearchState(stub(effects=()), stub(effects=(stub(),))),
        SearchState(stub(effects=()), stub(effects=())),
    )
    again = replace(first, state=SearchState(stub(effects=()), stub(effects=(stub(),))), dataset=more.dataset)
    begun = replace(first, state=wrong)

    def judge(selection: Selection, clock: Any) -> Findings:
        return judged(replace(selection, state=plain) if selection.state is wrong else selection, clock)

    steps: dict[str, Any] = {
        "promote_validation": lambda study, dataset, state, others: more if state is plain else None,
        "find": lambda *args, **named: again,
        "replaces": lambda others, before, after, settles: before is plain,
        "judge": judge,
    }
    for name, step in steps.items():
        monkeypatch.setattr(further_searches, name, step)
    assert find_with_more(begun, stub(), stub(), stub()).state is again.state


def test_what_tells_rivals_apart_is_estimated_anew_and_settles(monkeypatch, stub, first, more) -> None:
    found = replace(first, state=SearchState(stub(effects=()), stub(effects=(stub(),))))
    more.same_effects, begun = True, []

    def find(*args: Any, before: Any, **named: Any) -> Selection:
        begun.append(before)
        return replace(found, dataset=more.dataset)

    monkeypatch.setattr(further_searches, "promote_validation", lambda *args: None)
    monkeypatch.setattr(further_searches, "promote_to_tell_apart", lambda *args: None if begun else more)
    monkeypatch.setattr(further_searches, "find", find)
    monkeypatch.setattr(further_searches, "replaces", lambda others, before, after, settles: settles)
    best = find_with_more(found, stub(), stub(), stub())
    assert begun == [found.state] and best.dataset is more.dataset and best.more == ("run 2 was taken",)


def test_positions_begin_where_the_search_and_the_held_out_windows_have_them(stub) -> None:
    names = ("angle", "arm.position")
    model = stub(states=[stub(name=n) for n in names], start_trials=lambda values: [{"arm.position": 0.0}])
    records = stub(names=("run 1",))
    found = stub(problem=stub(model=model, values=None, records=records, initial=np.array([[0.3, 2.5]])))
    others = stub(fits=lambda h: (h,), places=lambda h: {"run 2": {"arm.position": 1.5}})
    last: Any = stub(searched=found)
    told = {"run 1": {"arm.position": 2.5}, "run 2": {"arm.position": 1.5}}
    assert PLACES(last, others) == told  # type: ignore[arg-type]
    assert PLACES(last, stub(fits=lambda h: ())) == {}, "no window could be simulated"  # type: ignore[arg-type]
    model.start_trials = lambda values: []
    assert PLACES(last, others) == {}, "sensors show every position"  # type: ignore[arg-type]


def test_one_more_search_begins_from_all_that_was_found_before(monkeypatch, stub, first, more) -> None:
    searched, told = stub(effects=(stub(),)), []

    def find(*args: Any, found_before: Any, **named: Any) -> Selection:
        told.append(found_before)
        return replace(first, dataset=more.dataset, others=None)

    monkeypatch.setattr(further_searches, "promote_validation", lambda *args: more)
    monkeypatch.setattr(further_searches, "find", find)
    find_with_more(replace(first, searched=searched), stub(), stub(), stub())
    assert told == [searched]


@pytest.mark.parametrize("limited", [False, True])
@pytest.mark.parametrize(("replaced", "same"), [(True, True), (False, True), (True, False)])
def test_what_no_free_run_follows_is_chosen_with(monkeypatch, stub, first, more, replaced, same, limited) -> None:
    """Once; what is found with it takes the place of what was found before where it predicts the others no worse."""
    found = replace(first, state=SearchState(stub(effects=()), stub(effects=(stub(),))))
    again = replace(found, state=SearchState(stub(effects=()), stub(effects=(stub(),))), dataset=more.dataset)
    asked: list[Any] = []
    more.same_effects = same

    def judge(selection: Selection, clock: Any) -> Findings:
        runs: Any = stub(
            unstable=frozenset({"run 2"}) if selection.state is found.state else frozenset(), refused_in=""
        )
        return replace(judged(selection, clock), judged=runs)

    def search(*args: Any, **named: Any) -> Selection:
        asked.append(args)
        assert named["before"] is (found.state if more.same_effects else None)
        return again

    steps: dict[str, Any] = {
        "promote_validation": lambda *args: None,
        "promote_unstable": lambda dataset, unstable: more if unstable else None,
        "find": search,
        "replaces": lambda others, before, after, settles: replaced and settles,
        "judge": judge,
    }
    for name, step in steps.items():
        monkeypatch.setattr(further_searches, name, step)
    best = find_with_more(found, stub(), stub(), stub(), Deadline.after(60.0) if limited else Deadline())
    assert best.state is (again if replaced else found).state
    assert len(asked) == 1


def test_over_longer_windows_nothing_that_is_left_is_too_little(monkeypatch, stub, first) -> None:
    begun: list[dict[str, Any]] = []

    def find(dataset: Any, model: Any, make_study: Any, *rest: Any) -> Selection:
        begun.append(make_study.keywords)
        raise TimeIsUp

    monkeypatch.setattr(further_searches, "longer_windows", lambda *args: "longer")
    monkeypatch.setattr(further_searches, "find", find)
    first = replace(first, study=stub(working_on=lambda text: None))
    found = further_searches.find_what_is_slow(judged(first, None), stub(), partial(stub), stub())
    assert begun == [{"budget": "longer", "more_is_missing": True}]
    assert not found.complete and found.cut == (further_searches.LONGER,)
