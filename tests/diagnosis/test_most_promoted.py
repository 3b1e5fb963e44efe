"""No more validation experiments are taken to choose with than the settings allow, over all searches together."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import pytest

from greybox_torch.diagnosis import further_searches
from greybox_torch.diagnosis.further_searches import find_what_is_slow, find_with_more
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.selection import Selection
from tests.diagnosis.test_further_searches import judged, selection


def chosen(found: Selection) -> list[str]:
    return [r.name for r in found.dataset.estimation()]


@pytest.fixture
def first(stub, monkeypatch) -> Selection:
    """A search on one experiment, of a data set of which one more shows something ever again."""

    def data(count: int) -> Any:
        return stub(estimation=lambda: [stub(name=f"run {k + 1}") for k in range(count)], count=count)

    def promote(study: Any, dataset: Any, *_: Any) -> Any:
        more = data(dataset.count + 1)
        return stub(taken=f"run {more.count}", dataset=more, sentence=lambda: "taken", same_effects=False)

    state = SearchState(stub(effects=()), stub(effects=()))
    study = stub(working_on=lambda text: None, settings=stub(most_promoted=1))
    found = selection(state, data(1), study, stub())
    steps: dict[str, Any] = {
        "_places": lambda *_: {},
        "_promotion": lambda last, others: promote(last.study, last.dataset),
        "judge": judged,
        "find": lambda dataset, *_, **named: replace(found, dataset=dataset),
        "replaces": lambda *_: True,
        "longer_windows": lambda *_: "longer",
        "without_refinements_alone": lambda findings: findings,
        "stands": lambda *_: True,
        "explained_without": lambda *_: "",
        "sentence": lambda *_: "over longer windows",
    }
    for name, step in steps.items():
        monkeypatch.setattr(further_searches, name, step)
    return found


@pytest.mark.parametrize("most", [0, 1, 2])
def test_at_most_so_many(stub, first: Selection, most: int) -> None:
    first.study.settings.most_promoted = most  # type: ignore[misc]
    assert len(chosen(find_with_more(first, stub(), stub(), stub()))) == 1 + most


@pytest.mark.parametrize("most", [0, 1, 2])
def test_over_longer_windows_no_more_of_them(stub, first: Selection, most: int) -> None:
    """Seen: two experiments that were taken with ``most_promoted = 1``, the second one over longer windows."""
    first.study.settings.most_promoted = most  # type: ignore[misc]
    found = find_with_more(first, stub(), stub(), stub())
    assert len(chosen(find_what_is_slow(found, stub(), partial(stub), stub(), given=first.dataset))) == 1 + most
