"""How a limited time is shared: every stage has its part, and what must follow is kept."""

from __future__ import annotations

from dataclasses import astuple

import pytest

from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis.schedule import Schedule
from greybox_torch.diagnosis.settings import SearchBudget

BUDGET = SearchBudget(
    share_for_confirming=0.2, share_for_final_fits=0.1, comparisons_to_come=4.0, seconds_for_writing=1.0
)


def test_parts_of_a_limit() -> None:
    end = Deadline.after(25.0)
    found = Schedule.within(end, 1.0, BUDGET)
    before_the_end = [end.at - at for (at,) in astuple(found)]
    assert before_the_end == pytest.approx([5.0 + 6.0, 5.0 + 2.0, 5.0, 1.0], abs=0.05)


def test_without_a_limit_nothing_ends() -> None:
    assert Schedule.within(Deadline(), 1.0, BUDGET) == Schedule()


def test_where_nothing_is_left_only_what_must_be_is_done() -> None:
    found = Schedule.within(Deadline.after(2.0), 1.0, BUDGET)
    assert found.searching.passed and found.confirming.passed and found.fitting.passed and not found.judging.passed
