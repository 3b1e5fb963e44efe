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


def test_of_many_candidates_their_number_is_told() -> None:
    many = tuple((f"body_{k}", "constant_bias") for k in range(MOST_NAMED + 1))
    (told,) = NotTried((), many).sentences()
    assert told == "Not tried any more: 13 mechanisms at ports, which verdict.json lists (not_tried)."
    assert len(NotTried((), many).as_json()["candidates"]) == 13
