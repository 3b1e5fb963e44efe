"""Two ways from the same start: from what explains most over all window lengths, and from what explains the short ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.hypothesis.noise import at_floor
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate, contains, shortlist
from greybox_torch.diagnosis.select.choice import priced_score
from greybox_torch.diagnosis.select.forward import take_effects
from greybox_torch.diagnosis.select.forward_step import forward_step
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import Stage, result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def explore(study: Study, start: SearchState) -> Stage[SearchState]:
    """Take effects while it pays; where the first choice passed over what explains short windows, also from there: the better result.

    Two effects that need one another show over short windows, where start states take up what is slow; over long ones neither of
    them helps alone, and something that is not there may do better than either.
    """
    first = yield from take_effects(study, start)
    if len(first.steps) == len(start.steps) or nothing_is_left(study, first):
        return first
    passed = passed_over(study, start, first.steps[len(start.steps)])
    if passed is None or passed.attachment.prefix in first.prefixes:
        return first
    other, chosen_again = _from_given(study, start, first, passed)
    price = partial(priced_score, settings=study.settings)
    if chosen_again and price(other.current) <= price(first.current) - study.settings.curve_margin:
        return other
    return replace(first, plain=other.plain)  # what else the rejected way knows is not about these effects


def nothing_is_left(study: Study, state: SearchState) -> bool:
    """Whether what was found leaves no more than the noise over windows of any length: no other way leads farther."""
    return bool(state.effects) and all(at_floor(study.problem, f, study.settings) for f in state.current.fits)


def passed_over(study: Study, before: SearchState, done: SelectionStep) -> Candidate | None:
    """The named effect that explains most over the shortest windows, if what was taken explains far less of it."""
    if done.taken is None or done.taken.unknown:
        return None
    shortest, settings = done.screened[0], study.settings
    found = [k for k in shortlist(study, done.screened, before.current.fits) if not k.unknown]
    shares = {k.attachment.prefix: _explained(shortest, k.attachment) for k in found}
    best = max(found, key=lambda k: shares[k.attachment.prefix], default=None)
    if best is None or shares[best.attachment.prefix] < settings.passed_over_share:
        return None
    contained = [k for k in found if contains(best.attachment, k.attachment)]
    best = next(
        (
            k
            for k in contained
            if shares[k.attachment.prefix] > settings.passed_over_simpler * shares[best.attachment.prefix]
        ),
        best,
    )
    taken = _explained(shortest, done.taken.candidate.attachment)
    return best if taken < settings.passed_over_ratio * shares[best.attachment.prefix] else None


def _from_given(study: Study, start: SearchState, first: SearchState, given: Candidate) -> tuple[SearchState, bool]:
    """The search from ``start`` with an effect given, which is then chosen once more beside the others; whether it was, or is not needed.

    What it knows of the plain model it has from ``first``, the other way. Until the given effect is chosen no state of this way is
    complete: nothing would say how probable it is. What it led to may do without it.
    """
    with_given = refitted(study, (*start.effects, given.attachment), start.current, given.starts)
    if with_given is None:
        return first, False
    reached = result_of(take_effects(study, replace(first.at(with_given), steps=start.steps)))
    rest = tuple(e for e in reached.effects if e is not given.attachment)
    without = refitted(study, rest, reached.current) if rest else start.current
    if without is None:
        return reached, False
    again = result_of(forward_step(study, replace(reached.at(without), steps=start.steps)))
    chosen_again = not again.steps[-1].ranked[0].unknown if again.took_one else bool(rest)
    later = reached.steps[len(start.steps) :]
    again = replace(again, steps=(*again.steps, *(s for s in later if s.taken is not None or s is later[-1])))
    if chosen_again and reached.current.score < again.current.score and reached.prefixes == again.prefixes:
        again = again.at(reached.current)
    return again, chosen_again


def _explained(scores: Sequence[ScreenScore], attachment: Attachment) -> float:
    """The most that any probe of an effect explains."""
    return max((k.explained for k in scores if k.attachment.prefix == attachment.prefix), default=0.0)
