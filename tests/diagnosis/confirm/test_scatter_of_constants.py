"""How far a law's size may differ between experiments."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.confirm import longer_windows as module
from greybox_torch.diagnosis.confirm.longer_windows import constant_effect
from greybox_torch.diagnosis.confirm.same_everywhere import CHANCE, CHANCE_FAR_ABOVE
from greybox_torch.mechanisms.balance import LinearLeak
from greybox_torch.mechanisms.forces import ConstantBias


@pytest.mark.parametrize(
    ("law", "lost", "chance"),
    [(LinearLeak(), True, CHANCE_FAR_ABOVE), (LinearLeak(), False, CHANCE), (ConstantBias(), True, CHANCE)],
)
def test_a_law_that_is_no_offset_may_scatter_where_free_runs_hardly_follow_without_it(
    stub, monkeypatch, law: Any, lost: bool, chance: float
) -> None:
    asked: list[float] = []
    monkeypatch.setattr(module, "same_everywhere", lambda *given: asked.append(given[-1]) or True)
    current = stub(values=dict, model=stub(start_trials=lambda values: ()), problem=stub(values=()))
    study = stub(surroundings={"tank": None}, settings=None, budget=None)
    effect = stub(prefix="tank.law", port="tank", mechanism=law)
    assert constant_effect(study, stub(current=current), stub(problem=None, begun=None), effect, lost)
    assert asked == [chance]
