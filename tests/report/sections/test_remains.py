"""The section that says what is left."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.verdict import Left
from greybox_torch.report.sections.remains import Remains


def test_nothing_is_said_where_it_is_not_known(verdict) -> None:
    assert Remains.of(replace(verdict, left=None)) is None


def test_refinements_are_listed_largest_first(verdict) -> None:
    effect = Effect("motor", "backlash", 0.3, (), "", {}, 0.0, (), None)
    small = (replace(effect, port="a", size=0.002), replace(effect, port="b", size=0.004))
    found = Remains.of(replace(verdict, left=Left(0.1, 2.0, "10 % remains."), refinements=small))
    assert found is not None
    assert found.sentence == "10 % remains."
    assert [(r.port, r.size) for r in found.refinements] == [("b", "0.4 %"), ("a", "0.2 %")]
