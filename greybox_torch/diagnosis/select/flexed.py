"""A law found may flex before another is named beside it.

Where a law with fewer parameters removes nearly all of the mismatch, it is taken before one that contains it. What it then lacks is small
beside the mismatch and large beside the noise, and some law at another port takes up most of it. So once another effect pays, the laws
that contain what was found are asked first: one effect that comes as far as two is the machine's.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.screen.shortlist import contains
from greybox_torch.diagnosis.select.choice import priced_score
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def flexed(study: Study, before: SearchState, after: SearchState) -> SearchState | None:
    """``before`` with one of its laws replaced by one that contains it, where that comes as far as ``after`` with one more effect.

    None where no such law does, or where ``after`` took nothing.
    """
    if not after.took_one:
        return None
    to_reach = priced_score(after.current, study.settings)
    for effect, done, wider in wider_laws(study, before):
        found = in_its_place(study, before, effect, done, wider)
        if found is not None and priced_score(found, study.settings) <= to_reach:
            return replace(widened(before, done, wider, found), plain=after.plain)
    return None


def wider_laws(study: Study, state: SearchState) -> Iterator[tuple[Attachment, SelectionStep, RankedCandidate]]:
    """The laws of a state with the step that took each, and the best law of that step that contains it and is not there itself."""
    for effect in state.effects:
        done = state.step_of(effect.prefix)
        if done is None or done.taken is None:
            continue
        others = (r for r in done.ranked if r.candidate.attachment.prefix not in state.prefixes)
        contain = (r for r in others if contains(r.candidate.attachment, effect) and sound(study, r))
        wider = next(contain, None)
        if wider is not None and wider.fitted.score < done.taken.fitted.score:
            yield effect, done, wider


def in_its_place(
    study: Study,
    state: SearchState,
    effect: Attachment,
    done: SelectionStep,
    other: RankedCandidate,
    starts: Sequence[dict[str, float]] = (),
) -> Hypothesis | None:
    """The hypothesis of ``state`` with ``other``, of the step that took ``effect``, in the place of that.

    Args:
        starts: further values to begin with than those of ``state`` with the law's own.
    """
    if state.effects == (*done.parent.effects, effect):
        return other.fitted
    return refitted_in_its_place(study, state, effect, other, starts)


def refitted_in_its_place(
    study: Study,
    state: SearchState,
    effect: Attachment,
    other: RankedCandidate,
    starts: Sequence[dict[str, float]] = (),
) -> Hypothesis | None:
    """The same, refitted from the values of ``state`` and the law's own in any case."""
    law = other.candidate.attachment
    study.working_on(f"trying {law.prefix} in the place of {effect.prefix}")
    own = {n: v for n, v in other.fitted.values().items() if n.startswith(f"{law.prefix}.")}
    return fit(study, state.with_law(effect, law), [state.current.values() | own, *starts], state.current.fits[0])


def widened(state: SearchState, done: SelectionStep, wider: RankedCandidate, found: Hypothesis) -> SearchState:
    """``state`` with the hypothesis ``found``, as if its step ``done`` had taken ``wider``."""
    taken = replace(wider, fitted=found)
    steps = tuple(replace(s, taken=taken, led=None) if s is done else s for s in state.steps)
    return replace(state.at(found), steps=steps)
