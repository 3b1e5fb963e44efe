"""What a stage of the search has yielded where it is interrupted while it tries something: the best that was complete before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from greybox_torch.deadline import TimeIsUp
from greybox_torch.diagnosis.select import explore as exploring
from greybox_torch.diagnosis.select import forward as advancing
from greybox_torch.diagnosis.select import names_for_curve
from greybox_torch.diagnosis.select import search as searching
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.stopping import best_so_far, only_if, or_else, result_of

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()


def state(stub, score: float, *names: str, steps: tuple[Any, ...] = ()) -> SearchState:
    """A state of which only the names of its effects and its score are known."""
    effects = tuple(stub(prefix=n, port=n.split(".")[0], mechanism=None) for n in names)
    fitted = stub(effects=effects, score=score, problem=stub(free=np.zeros(0, bool)))
    return SearchState(stub(effects=(), score=0.0), fitted, steps)


def yielding(*states: SearchState, then: type[BaseException] | None = None) -> Callable[..., Any]:
    """A stage that yields some states, and is interrupted after them or returns the last."""

    def stage(*args: Any, **kwargs: Any):
        yield from states
        if then is not None:
            raise then
        return states[-1]

    return stage


@pytest.mark.parametrize("stop", [KeyboardInterrupt, TimeIsUp])
def test_what_was_yielded_last_is_the_answer(stub, stop) -> None:
    begun, one, two = (state(stub, -k) for k in range(3))
    assert best_so_far(yielding(one, two, then=stop)(), begun) == (two, False)
    assert best_so_far(yielding(one, two)(), begun) == (two, True)
    assert best_so_far(yielding(then=stop)(), begun) == (begun, False)
    assert or_else(lambda: result_of(yielding(one, then=stop)()), lambda: begun) == (begun, False)


def test_other_errors_are_not_swallowed(stub) -> None:
    with pytest.raises(ZeroDivisionError):
        best_so_far(yielding(state(stub, 0.0), then=ZeroDivisionError)(), state(stub, 0.0))


def test_only_what_is_accepted_is_yielded(stub) -> None:
    one, two, three = (state(stub, -k) for k in range(3))
    stage = only_if(yielding(one, two, three)(), lambda s: s.current.score < -1.5)
    assert next(stage) is three
    with pytest.raises(StopIteration) as ended:
        next(stage)
    assert ended.value.value is three


@pytest.mark.parametrize("at", ["taking effects", "choosing once more"])
def test_on_the_way_from_a_given_effect_the_first_way_stands(monkeypatch, stub, at) -> None:
    """Seen: stopped there, a search answered with half of the second way, worse than what it had found before."""
    start, first = state(stub, 0.0), state(stub, -1.0, "rotor.drag", steps=(stub(),))
    partial_way = state(stub, -0.2, "rotor.bias")
    given = stub(attachment=stub(prefix="rotor.bias"), starts=())
    ways = iter([yielding(first), yielding(partial_way, then=KeyboardInterrupt if at == "taking effects" else None)])
    monkeypatch.setattr(exploring, "take_effects", lambda *args: next(ways)())
    monkeypatch.setattr(exploring, "nothing_is_left", lambda *args: False)
    monkeypatch.setattr(exploring, "passed_over", lambda *args: given)
    monkeypatch.setattr(exploring, "refitted", lambda *args: partial_way.current)
    monkeypatch.setattr(exploring, "forward_step", yielding(partial_way, then=KeyboardInterrupt))
    assert best_so_far(exploring.explore(stub(settings=SETTINGS), start), start) == (first, False)


@pytest.mark.parametrize(("score", "names_stand"), [(-0.5, False), (-0.9, True)])
def test_among_names_in_the_place_of_a_curve_the_curve_stands_until_they_come_as_far(
    monkeypatch, stub, score, names_stand
) -> None:
    before = state(stub, 0.0)
    curve = stub(unknown=True, candidate=stub(attachment=stub(port="rotor")))
    done = SelectionStep((), before.current, (stub(unknown=False),), curve)
    with_curve = state(stub, -1.0, "rotor.unknown", steps=(done,))
    names = state(stub, score, "rotor.drag", steps=(stub(taken=stub()),))
    monkeypatch.setattr(advancing, "take_best", yielding(names))
    monkeypatch.setattr(advancing, "take_effects", yielding(then=KeyboardInterrupt))
    monkeypatch.setattr(advancing, "with_richer_form", yielding(names))
    monkeypatch.setattr(names_for_curve, "alone_at_noise", lambda *args: False)
    monkeypatch.setattr(advancing, "with_first_of_two", lambda *args, **line: None)
    monkeypatch.setattr(names_for_curve, "joined_bodies", lambda model: [])
    best, ended = best_so_far(
        advancing._named_instead(stub(settings=SETTINGS, problem=stub(model=None)), before, with_curve), with_curve
    )
    assert not ended and best is (names if names_stand else with_curve)


def test_while_an_effect_is_chosen_once_more_the_whole_stands(monkeypatch, stub) -> None:
    whole = state(stub, -2.0, "rotor.drag", "rotor.bias")
    weaker = state(stub, -1.0, "rotor.bias")
    whole = SearchState(whole.plain, whole.current, (), {"rotor.drag": weaker.current})
    monkeypatch.setattr(searching, "explore", yielding(whole))
    monkeypatch.setattr(searching, "drop_superfluous", yielding(whole))
    monkeypatch.setattr(searching, "forward_step", yielding(weaker, then=KeyboardInterrupt))
    study = stub(working_on=lambda text: None, settings=SETTINGS, budget=BUDGET)
    assert best_so_far(searching.search(study, state(stub, 0.0)), weaker) == (whole, False)
