"""What is told while a diagnosis runs, and what was left when it was stopped."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.deadline import until
from greybox_torch.diagnosis.not_tried import MOST_NAMED, NotTried
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.diagnosis.progress import Journal, Progress
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.stopping import best_so_far
from greybox_torch.errors import NumericalError

DRAG, BIAS = ("rotor", "quadratic_drag"), ("rotor", "constant_bias")


def test_the_screen_leads_until_a_refit_does() -> None:
    heard: list[Progress] = []
    journal = Journal(heard.append)
    journal.doing("screening")
    journal.pointed_at((DRAG, 0.62))
    journal.found([BIAS], 0.943)
    journal.pointed_at((DRAG, 0.7), (BIAS, 0.4))
    journal.found([BIAS, DRAG], 0.99)
    journal.found([], 0.0)
    assert [now.leading for now in heard] == [
        "",
        "perhaps quadratic drag at rotor: 62 % in the screen",
        "constant bias at rotor: 94.3 % of the mismatch explained",
        "constant bias at rotor, and quadratic drag at rotor: 99 % of the mismatch explained",
        "",
    ]
    assert [now.effects for now in heard[1:]] == [(DRAG,), (BIAS,), (BIAS, DRAG), ()]
    assert all(now.doing == "screening" and now.seconds >= 0.0 for now in heard)


def test_candidates_that_are_left() -> None:
    journal = Journal()
    journal.offer([DRAG, BIAS])
    journal.begin(DRAG)
    assert journal.left == (BIAS,)
    journal.offer([])
    assert journal.left == ()
    journal.screened(20)
    journal.screened(3)
    assert journal.tests == 23


@pytest.mark.parametrize(("stage", "left"), [("screening", True), ("refitting", True), ("polishing", False)])
def test_a_search_ends_within_a_refit_and_says_what_was_left(dead_zone_search, stage: str, left: bool) -> None:
    """A few passes after a stage was begun, in the middle of it. Where that is the screen, none of what it offers was tried."""
    begun, journal, said = dead_zone_search.state, Journal(), []
    passes = iter(range(4))

    def stop() -> bool:
        return any(text.startswith(stage) for text in said) and next(passes, None) is None

    with until(stop):
        study = replace(dead_zone_search.study, journal=journal, report=said.append)
        state, ended = best_so_far(search(study, begun), begun)
    assert not ended and said[-1].startswith(stage)
    assert state.current.score <= begun.current.score
    assert bool(journal.left) == left
    assert sum(text.startswith(stage) for text in said) <= 4


def test_stopped_before_a_screen_has_ended(motor_data, motor) -> None:
    """Seen: Ctrl-C after the first line; the verdict spoke of 0 tests, and of no candidate that was not tried."""

    def stop(text: str) -> None:
        if text.startswith("screening"):
            raise KeyboardInterrupt

    verdict = diagnose(motor_data(400, torque=lambda q, v: -0.004 * v * abs(v)), motor, progress=stop).verdict
    left = verdict.not_tried.candidates
    assert len(left) == len(set(left)) > MOST_NAMED and {DRAG, BIAS, ("rotor", "torque_ripple")} <= set(left)
    assert verdict.evidence[0].startswith("The search was stopped before any mechanism was tested at a port; the model")


@pytest.mark.parametrize(
    ("cut", "after"), [("comparing the equations", 0), ("refitting rotor", 0), ("refitting rotor", 1)]
)
def test_stopped_after_the_screen_the_answer_says_what_that_points_to(motor_data, motor, cut: str, after: int) -> None:
    """Seen: 174 tests of a mechanism at a port, and "stopped before it could say what": which of them led was nowhere."""
    begun = iter(range(after))

    def stop(text: str) -> None:
        if text.startswith(cut) and next(begun, None) is None:
            raise KeyboardInterrupt

    verdict = diagnose(motor_data(400, torque=lambda q, v: -0.004 * v * abs(v)), motor, progress=stop).verdict
    assert not verdict.effects and ": so far, the screen points to " in verdict.sentence
    assert "quadratic drag at rotor (" in verdict.sentence and "which is not confirmed" in verdict.sentence
    pointed = verdict.as_json()["not_tried"]["pointed_at"]
    assert {"rotor"} == {one["port"] for one in pointed} and "quadratic_drag" in {one["mechanism"] for one in pointed}
    shares = [one["share"] for one in pointed]
    assert shares[0] <= 1.0 and shares == sorted(shares, reverse=True)


def test_where_a_step_has_ended_its_screen_is_not_told() -> None:
    journal = Journal()
    journal.pointed_at((DRAG, 0.98), (BIAS, 0.5))
    told = NotTried.of(False, (), journal, False).points_to
    assert told.startswith(
        "the screen points to quadratic drag at rotor (98 %), before constant bias at rotor (50 %), by"
    )
    assert NotTried.of(False, (), journal, True).points_to == NotTried.of(True, (), journal, False).points_to == ""


def test_the_leading_finding_is_told_and_is_the_answer_in_the_end(motor_data, motor) -> None:
    heard: list[Progress] = []
    found = diagnose(motor_data(400, torque=lambda q, v: -0.004 * v * abs(v)), motor, on_progress=heard.append)
    leading = [now for now in heard if now.explained is not None]
    assert leading and set(leading[-1].effects) == {(e.port, e.mechanism) for e in found.verdict.effects}
    assert any(now.leading.startswith("perhaps") for now in heard[: heard.index(leading[0])])
    assert found.verdict.not_tried.as_json() == {"stages": [], "candidates": []}


def test_what_a_callback_raises_ends_the_diagnosis(motor_data, motor) -> None:
    def hear(now: Progress) -> None:
        raise NumericalError("enough")

    with pytest.raises(NumericalError, match="enough"):
        diagnose(motor_data(400), motor, on_progress=hear)
