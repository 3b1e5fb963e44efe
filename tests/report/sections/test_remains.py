"""The section that says what is left."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.confirm.standing import BY_TIMING
from greybox_torch.diagnosis.effect import SO_LITTLE, Effect
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


def test_why_a_refinement_is_no_finding(verdict) -> None:
    """Seen: "input lag accounts for 64 % of the whole mismatch: so little that it may only compensate", a lag of a quarter of a sample."""
    lag = replace(Effect("valve", "input_lag", 0.3, (), "", {}, 0.0, (), None), size=0.64, why_small=BY_TIMING)
    found = Remains.of(replace(verdict, left=Left(0.1, 2.0, "10 % remains."), refinements=(lag,)))
    assert found is not None and [r.why for r in found.refinements] == [BY_TIMING]
    assert lag.sentence == f"input lag at valve accounts for 64 % of the whole mismatch: {BY_TIMING}"
    assert replace(lag, why_small=SO_LITTLE).sentence.endswith(f"mismatch: {SO_LITTLE}")
