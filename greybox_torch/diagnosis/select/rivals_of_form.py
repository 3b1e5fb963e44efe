"""The rivals of a law that was taken in a richer form, refitted from where that has the model's parameters.

A richer form may leave a valley in which all laws of its step ended, with parameters of the model that are far from the machine's. Its
rivals were compared there. Seen: play in a gear (0.13 rad), told as a stiffness that differs by direction (0.97): the plain stiffness, play
and errors of the gear explained a fifth of the mismatch each, the richer form 99.9 %, and play from there still more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged, sound
from greybox_torch.diagnosis.select.choice import chosen
from greybox_torch.diagnosis.select.flexed import refitted_in_its_place, widened
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.study import Study


def with_rivals_of_form(study: Study, state: SearchState) -> SearchState:
    """``state``, whose last step took a richer form, with the rivals of that step refitted; the best of them and the form is taken."""
    done, settings = state.steps[-1], study.settings
    form = done.taken
    if form is None or len(state.effects) != len(done.parent.effects) + 1:
        return state
    found = {
        id(rival): better for rival in _asked(study, done, form) if (better := _refitted(study, state, form, rival))
    }
    if not found:
        return state
    ranked = [found.get(id(r), r) for r in done.ranked]
    farther = in_order([*(r for r in found.values() if sound(study, r)), form], settings)
    best = chosen(farther, state.plain, settings) or form
    if best is not form:  # then the form is one of the rivals, and the plain one is no other
        own = form.candidate.attachment.prefix
        ranked = [*(r for r in ranked if r.candidate.attachment.prefix != own), form]
    step = replace(done, ranked=tuple(in_order(ranked, settings)))
    state = replace(state, steps=(*state.steps[:-1], step))
    return state if best is form else widened(state, step, best, best.fitted)


def _asked(study: Study, done: SelectionStep, form: RankedCandidate) -> Iterator[RankedCandidate]:
    """The named rivals of a form, those at its port first, then the best ones."""
    law = form.candidate.attachment
    others = [r for r in done.ranked if not r.unknown and r.candidate.attachment.prefix != law.prefix]
    others.sort(key=lambda r: r.candidate.attachment.port != law.port)
    return islice(others, study.budget.front_runners)


def _refitted(
    study: Study, state: SearchState, form: RankedCandidate, rival: RankedCandidate
) -> RankedCandidate | None:
    """A rival in the place of the form, refitted from its own values and the form's of the model; None where that is no better."""
    fitted = refitted_in_its_place(study, state, form.candidate.attachment, rival)
    if fitted is None or fitted.score >= rival.fitted.score:
        return None
    return judged(rival.candidate, state.steps[-1].parent, fitted, study.settings)
