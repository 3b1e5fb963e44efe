"""Why what is missing has no name: no more is denied than was tried, and what was nearly found is told."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.not_tried import NotTried
from tests.diagnosis.test_verdict import verdict

MISSING = replace(verdict(), unexplained=12.0)
UNSURE = "gravity at arm would lower its mean square by 89 %, but is 2.4 standard errors from chance"


def test_all_was_tried() -> None:
    assert MISSING.sentence.endswith(
        "No law of the library and no curve of one signal explains it, with or without memory."
    )


def test_of_laws_that_beliefs_exclude_nothing_is_said() -> None:
    """Seen: "no curve of one signal explains it" beside beliefs that exclude all curves."""
    told = replace(MISSING, beliefs=Beliefs({"*/unknown": 0.0})).sentence
    assert told.endswith("None of the laws and curves that were tried explains it (the beliefs exclude others).")
    assert "No law of the library" in replace(MISSING, beliefs=Beliefs({"*/unknown": 0.1})).sentence


def test_a_candidate_that_is_not_sure_is_told_in_the_sentence() -> None:
    """Seen: "no law explains it", and four lines below that gravity would lower the error by 89 %."""
    told = replace(MISSING, unsure=UNSURE).sentence
    assert told.endswith(f"no curve of one signal surely explains it, with or without memory: {UNSURE}.")
    stopped = replace(MISSING, unsure=UNSURE, complete=False).sentence
    assert stopped.endswith(f"The search was stopped before it could say what: so far, {UNSURE}.")


def test_what_a_stopped_search_points_to_is_told_whether_or_not_the_error_is_above_the_noise() -> None:
    """Seen: "stopped before it could say what" after 174 tests of the screen; which of them led was nowhere."""
    pointed = NotTried(pointed_at=((("rotor", "quadratic_drag"), 0.981),))
    told = "so far, the screen points to quadratic drag at rotor (98.1 %), by the share of the error over windows explained there"
    for found in (MISSING, verdict()):
        stopped = replace(found, complete=False, not_tried=pointed).sentence
        assert f": {told}, which is not confirmed." in stopped
        assert UNSURE in replace(found, complete=False, not_tried=pointed, unsure=UNSURE).sentence


def test_an_error_above_the_noise_is_told_beside_nothing_missing() -> None:
    """Seen: "Nothing is missing …" and, four lines below, "4.8 times the noise …: more than noise is left"."""
    found = replace(verdict(), disturbed=4.76)
    assert not found.mismatch and found.sentence == (
        "Nothing is missing from Motor that these recordings can show (confidence 0.95), but on the worst experiment its error is 4.76 "
        "times the noise (read from the recordings' highest frequencies): it follows neither the inputs nor any law that was tried, and "
        "whether a disturbance leaves it or something that the model lacks is not known."
    )
