"""Rivals of a choice in its place, beside everything else that was found.

A choice is made while other effects are still missing. Where these leave more than the difference by which a rival lost, that difference
may be theirs. Seen: a lag of an actuator, told as a dead time (0.97), which did better as long as a stop was missing.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.select.choice import priced_score
from greybox_torch.diagnosis.select.flexed import in_its_place
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def rivalled_beside_others(study: Study, state: SearchState, effect: Attachment) -> bool:
    """Whether a rival of ``effect`` comes as far in its place, beside the effects that were found after it."""
    least = priced_score(state.current, study.settings) + study.settings.least_gain
    return any(priced_score(h, study.settings) < least for h in rivals_in_its_place(study, state, effect))


def rivals_in_its_place(
    study: Study, state: SearchState, effect: Attachment, margin: float = 0.0
) -> Iterator[Hypothesis]:
    """The hypothesis of ``state`` with each rival of ``effect`` instead that came near it in the step that took it, the best first.

    Args:
        margin: by how much a rival may have lost (difference of scores) where later effects gained less than that.
    """
    done = state.step_of(effect.prefix)
    if done is None or done.taken is None or effect.mechanism.free:
        return
    for rival in islice(_near(study, state, effect, done, margin), study.budget.front_runners):
        there = state.current.values() | rival.fitted.values()
        fitted = in_its_place(study, state, effect, done, rival, [there])
        if fitted is not None:
            yield fitted


def _near(
    study: Study, state: SearchState, effect: Attachment, done: SelectionStep, margin: float
) -> Iterator[RankedCandidate]:
    """The named rivals of a step, best first, that lost by less than what came later gained, or by less than ``margin``."""
    of_its_name = (r.fitted.score for r in done.ranked if r.candidate.attachment.prefix == effect.prefix)
    reached = min(of_its_name, default=state.current.score)
    for r in done.ranked:
        there = r.unknown or r.candidate.attachment.prefix in state.prefixes
        if not there and r.fitted.score - reached < max(reached - state.current.score, margin) and sound(study, r):
            yield r
