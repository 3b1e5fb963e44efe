"""A slip on the card that explains the mismatch far better than what was found: the verdict begins with the question about it."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import held_out_scores, mean_fit


def with_question(verdict: Verdict, question: str, reaches: float, lead: str) -> Verdict:
    """The verdict with a question to the user, first and with effects that are doubtful where the change that it is about explains far
    more than these do.

    Seen: a current of the other sign, told as an unknown effect at the actuator (0.97), which left 130 times the noise; the question, a few
    lines below, was about what left hardly anything.

    Args:
        question: without its full stop.
        reaches: the mean fit in % on the validation experiments with the channels as the question has them.
        lead: how the question begins, up to what was changed: of a scale it is a no that explains the error.
    """
    settings, reached = verdict.settings, mean_fit(held_out_scores(verdict.counted("augmented")))
    asked = replace(verdict, question=question)
    if not verdict.effects or not 100.0 - reaches < settings.far_more_by_a_question * (100.0 - reached):
        return asked
    highest = settings.highest_probability_beside_a_question
    why = f"no more than {highest:.2f} is claimed for it, as a slip on the card, which is asked about, would explain far more"
    doubtful = tuple(_doubtful(e, highest, why) for e in verdict.effects)
    return replace(asked, question_first=lead, effects=doubtful, confidence=min(verdict.confidence, highest))


def _doubtful(effect: Effect, highest: float, why: str) -> Effect:
    """An effect that is no surer than that, nor is the class that it is told in."""
    surest = max(effect.probability, 0.0 if effect.one_of is None else effect.one_of.probability)
    limited = (*effect.limited, why) if surest > highest else effect.limited
    return replace(effect.no_surer_than(highest, highest), limited=limited)
