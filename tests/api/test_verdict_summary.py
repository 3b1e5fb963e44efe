"""What a verdict says beside its sentence and its tables."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.api.verdict_summary import notes
from greybox_torch.diagnosis.verdict import MOST_NAMED, STOPPED, NotTried
from tests.diagnosis.test_verdict import BACKLASH, verdict

CUT = NotTried(("searching",), (("rotor", "quadratic_drag"), ("rotor", "constant_bias")))


@pytest.mark.parametrize("effects", [(), (BACKLASH,)])
def test_a_search_that_was_stopped_says_so_and_what_was_not_tried(effects) -> None:
    """Seen: a diagnosis stopped after its first finding; the console said nothing of it."""
    told = notes(replace(verdict(*effects, complete=False), evidence=("some tests", STOPPED), not_tried=CUT))
    assert told.count(STOPPED) == 1
    assert told[-2:] == [
        "Cut short: searching.",
        "Not tried any more: quadratic drag at rotor, constant bias at rotor.",
    ]


@pytest.mark.parametrize("effects", [(), (BACKLASH,)])
def test_a_whole_search_says_nothing_of_it(effects) -> None:
    assert not any("stopped" in line or "Not tried" in line for line in notes(verdict(*effects)))


def test_parameters_that_are_not_determined_are_told() -> None:
    """Seen: a nonlinear stiffness with F_0 = 0.39 ± 4.1 in the table, without a word."""
    entry = {"unit": "N", "description": ""}
    vague, infinite = {"value": 0.39, "std": 4.1, **entry}, {"value": -2.0, "std": float("inf"), **entry}
    effect = replace(BACKLASH, parameters={"half_gap": {"value": 0.03, "std": 0.001, **entry}, "F_0": vague})
    told = [line for line in notes(verdict(effect)) if "standard deviation" in line]
    assert told == [
        "backlash at gear_spring: F_0: the standard deviation is larger than the value; it may be zero, or these recordings do not "
        "determine it beside the other parameters"
    ]
    both = replace(BACKLASH, parameters={"F_0": vague, "d_0": infinite})
    assert both.undetermined.startswith("F_0, d_0: ") and "they may be zero" in both.undetermined
    assert replace(BACKLASH, parameters={"F_0": {"value": 1.0, "std": 0.9, **entry}}).undetermined == ""
    assert replace(BACKLASH, parameters={"F_0": {"value": 1.0, "std": None, **entry}}).undetermined == ""


def test_what_refinements_explain_is_told() -> None:
    """Seen: friction that "explains 65 %" with 0.001 % of the mismatch left; a refinement had the rest."""
    small = replace(BACKLASH, mechanism="nonlinear_stiffness", explained=0.348, size=0.0007)
    told = notes(replace(verdict(BACKLASH), refinements=(small,)))
    assert told[-1].startswith("The refinements have 35 % of the explained error")
    assert not any("refinements have" in line for line in notes(verdict(BACKLASH)))


def test_of_many_candidates_their_number_is_told() -> None:
    many = tuple((f"body_{k}", "constant_bias") for k in range(MOST_NAMED + 1))
    (told,) = NotTried((), many).sentences()
    assert told == "Not tried any more: 13 mechanisms at ports, which verdict.json lists (not_tried)."
    assert len(NotTried((), many).as_json()["candidates"]) == 13
