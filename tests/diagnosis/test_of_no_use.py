"""A model that simulates the validation experiments worse than a constant is said to be of no use, whatever is explained."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.api.verdict_summary import notes
from greybox_torch.estimate.comparison import Score
from greybox_torch.report.sections.headline import Headline
from tests.diagnosis.test_verdict import BACKLASH, scores, verdict


def test_a_negative_validation_fit_is_told_beside_what_was_found() -> None:
    """Seen: 94.9 % of the mismatch explained, a validation fit of -94.3 %, and not a word of it."""
    found = replace(verdict(BACKLASH), scores={s: scores(-93.3) for s in ("start", "refit", "augmented")})
    (told,) = found.of_no_use
    assert told == (
        "The model with what was found simulates the validation experiments worse than a constant would (validation fit -94.3 %): it is "
        "of no use for predicting them, though it explains much of the error over short windows. A column may have another sign, scale or "
        "meaning than the card says, or a term of the equations the wrong sign."
    )
    assert found.sentence.endswith(
        "; windows show it, while free runs say little: with it the validation fit goes from -94.3 % to -94.3 %."
    )
    lost = replace(found, scores={s: scores(-4321.0) for s in ("start", "refit", "augmented")})
    assert "(validation fit below -1000 %)" in lost.of_no_use[0]
    assert notes(found)[0] == told and told in Headline.of(found).beside


def test_a_model_of_which_something_unnamed_is_missing() -> None:
    bad = {s: scores(-93.3) for s in ("start", "refit", "augmented")}
    missing = replace(verdict(), scores=bad, unexplained=12.0)
    assert missing.of_no_use[0].startswith("The model as it stands, re-estimated, simulates") and missing.of_no_use[
        0
    ] in notes(missing)
    assert replace(verdict(), scores=bad).of_no_use == (), "nothing is missing: noise alone may leave as much"


@pytest.mark.parametrize("fit", [0.5, 90.0])
def test_no_word_where_it_predicts(fit: float) -> None:
    assert (
        replace(verdict(BACKLASH), scores={s: scores(fit + 1.0) for s in ("start", "refit", "augmented")}).of_no_use
        == ()
    )


def test_runs_that_overflow_and_data_without_validation() -> None:
    lost = (Score("Run 2", "validation", "speed", float("-inf"), float("inf")),)
    found = replace(verdict(BACKLASH), scores=dict.fromkeys(("start", "refit", "augmented"), lost))
    assert "(a run of it overflows)" in found.of_no_use[0]
    alone = (Score("Run 1", "estimation", "speed", -20.0, 0.2),)
    assert replace(found, scores=dict.fromkeys(("start", "refit", "augmented"), alone)).of_no_use == ()
