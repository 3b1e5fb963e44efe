"""What free runs say of other searches, where nothing lasts of what was selected."""

from __future__ import annotations

from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.diagnosis.findings import Findings
from greybox_torch.diagnosis.further_searches import _another
from greybox_torch.diagnosis.schedule import Schedule
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.selection import Selection


def selection(stub: Any, *effects: str) -> Selection:
    found: Any = stub(effects=effects)
    nothing: Any = stub()
    state = SearchState(stub(effects=()), found)
    return Selection(
        dataset=nothing, study=nothing, state=state, searched=found, others=None, gains={}, free_runs=nothing, schedule=Schedule()
    )  # fmt: skip


def judged(selected: Selection) -> Findings:
    runs: Any = SimpleNamespace(unstable=frozenset(), refused_in="")
    return Findings(**{f.name: getattr(selected, f.name) for f in fields(Selection)}, judged=runs)


@pytest.mark.parametrize("holds", [True, False])
def test_another_search_is_judged_where_nothing_lasts_of_what_was_selected(stub, holds) -> None:
    """Seen: a ferry that heels as it turns: free runs were no better with what was selected, and never asked of what was not."""
    own, other, empty = judged(selection(stub)), selection(stub, "roll.unknown"), selection(stub)
    cut = replace(selection(stub, "roll.drag"), complete=False)
    asked = []

    def judge(selected: Selection) -> Findings:
        asked.append(selected)
        return judged(selected if holds else empty)

    known = {("e0",): own, ("e0", "e1"): other, ("e0", "e2"): empty, ("e0", "e3"): cut}
    found = _another(known, own, judge)
    assert [s.state for s in asked] == [other.state]
    assert found.state is other.state if holds else found is own


def test_what_was_judged_is_not_judged_again(stub) -> None:
    own, judged_before = judged(selection(stub)), judged(selection(stub, "roll.unknown"))
    assert _another({("e0",): judged_before, ("e0", "e1"): own}, own, lambda s: pytest.fail("judged twice")) is own
