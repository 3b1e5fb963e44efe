"""One more law, of which few windows were not sure, beside effects that free runs do not bear out without it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.confirm.far_better import Standing, leaving_far_less
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.select.choice import least_gain
from greybox_torch.diagnosis.select.remaining import completes
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.study import Study


def with_one_more(study: Study, state: SearchState, others: HeldOut | None, judged: Judgement) -> Standing | None:
    """``state`` with the law that leaves hardly more than noise beside its effects, though few windows are not sure of it; None where there
    is none, or where free runs do not leave half of the mismatch or less with it, or held-out windows do not bear all out beyond chance.

    Seen: a stage's drag, found beside a small constant force that windows could not tell from chance (1.7 standard errors): alone, the drag
    came out worse in a free run, was taken back, and an unknown curve (0.97) was told.
    """
    asked = None if others is None else _not_sure(study, state)
    if others is None or asked is None:
        return None
    done, law = asked
    study.working_on(f"asking held-out experiments about {law.candidate.attachment.prefix}")
    more = replace(state.at(law.fitted), steps=(*state.steps, replace(done, taken=law)))
    least = min(judged.mismatch(True), judged.mismatch(False))
    return leaving_far_less(study, more, others, judged, lambda by_it: least, partial(with_each_left_out, study, state))


def _not_sure(study: Study, state: SearchState) -> tuple[SelectionStep, RankedCandidate] | None:
    """The last step from the effects of ``state`` that took none, and the best law that was refused there and completes the model.

    One that was taken once, and gone since, is not asked again.
    """
    if state.has_curve:
        return None
    for done in reversed(state.steps):
        if done.taken is None and done.parent.effects == state.effects:
            for law in done.ranked:
                new = not law.unknown and state.step_of(law.candidate.attachment.prefix) is None
                pays = new and law.gain > least_gain(law.fitted, study.settings)
                if pays and sound(study, law) and completes(law.fitted, study.settings):
                    return done, law
    return None


def with_each_left_out(study: Study, state: SearchState, more: SearchState) -> SearchState:
    """``more``, which is ``state`` and a law that joined it, with what it is without each of its effects."""
    return replace(more, without={p: _without_one(study, state, more, p) for p in more.prefixes})


def _without_one(study: Study, state: SearchState, more: SearchState, prefix: str) -> Hypothesis:
    """The hypothesis of ``more`` without one of its effects: that of ``state`` without the law that joined it."""
    if prefix not in state.prefixes:
        return state.current
    rest = tuple(e for e in more.effects if e.prefix != prefix)
    return refitted(study, rest, more.current) or state.plain
