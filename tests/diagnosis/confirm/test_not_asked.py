"""Effects that held-out windows could not be asked about in time."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.confirm import not_asked as module
from greybox_torch.diagnosis.confirm.not_asked import without_what_free_runs_do_not_need
from greybox_torch.diagnosis.select.state import SearchState

LEFT = {"both": 0.10, "friction": 0.03, "ripple": 0.5}
"""What free runs leave with either law alone, and with both."""


@pytest.fixture
def both(stub):
    laws = tuple(stub(prefix=name) for name in ("friction", "ripple"))
    current, friction, ripple = (
        stub(name=name, effects=tuple(e for e in laws if name in ("both", e.prefix))) for name in LEFT
    )
    return SearchState(stub(effects=()), current, without={"ripple": friction, "friction": ripple})


@pytest.fixture
def study(stub, monkeypatch):
    monkeypatch.setattr(module, "finish", lambda hypothesis, *rest: hypothesis)
    return stub(settings=None, budget=None, recorded=None)


def judgement(stub, name: str, left: dict[str, float], holds: bool = True):
    def having(final, places):
        return judgement(stub, final.name, left, holds)

    return stub(mismatch=lambda effects: left[name], having=having, holds=holds, name=name)


@pytest.mark.parametrize(
    ("alone", "holds", "kept"), [(0.03, True, 1), (0.10, True, 1), (0.2, True, 2), (0.03, False, 2)]
)
def test_what_free_runs_do_not_need_goes(stub, study, both, alone: float, holds: bool, kept: int) -> None:
    judged, others = judgement(stub, "both", LEFT | {"friction": alone}, holds), stub(places=lambda hypothesis: {})
    state, by_it = without_what_free_runs_do_not_need(study, both, others, judged)
    assert len(state.effects) == kept and by_it.name == ("friction" if kept == 1 else "both")


def test_one_alone_and_what_was_not_compared_stay(stub, study, both) -> None:
    others, judged = stub(places=lambda hypothesis: {}), judgement(stub, "both", LEFT)
    for state in (both.at(both.current), both.at(both.without["ripple"])):
        assert without_what_free_runs_do_not_need(study, state, others, judged) == (state, judged)
