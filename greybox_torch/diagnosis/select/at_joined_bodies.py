"""The law of one body at the bodies that springs join with it.

At either end of a spring a force does nearly the same, and which end the screen offers is decided by tangents at the model as it stands.
What the wrong end leaves, some other law takes up. Seen: a stop of an arm, told as one of its gearbox (0.97) and, for what that left, as a
spring that stiffens (0.97); at the arm the stop alone leaves a fifth of the squared error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise
from greybox_torch.diagnosis.refit.possible_form import possible_form
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged, sound
from greybox_torch.diagnosis.refit.refitted import fit, refitted
from greybox_torch.diagnosis.refit.twins import renamed
from greybox_torch.diagnosis.select.choice import chosen
from greybox_torch.diagnosis.select.flexed import widened
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.model.joined_bodies import joined_bodies


def at_joined_bodies(study: Study, state: SearchState) -> SearchState:
    """``state`` with the law of its last step at the joined body where it goes farthest; asked where more than noise is left.

    Only at bodies where it had no turn in that step and is not there already. What was asked is a rival there in any case.
    """
    done = state.steps[-1]
    taken = done.taken
    if taken is None or taken.unknown or only_noise(study.problem, state.current, study.settings):
        return state
    there = {r.candidate.attachment.named for r in done.ranked} | {e.named for e in done.parent.effects}
    laws = [law for law in _elsewhere(study, taken.candidate.attachment) if law.named not in there]
    moved = [found for law in laws if (found := _moved(study, state, taken, law)) is not None]
    if not moved:
        return state
    moved += _contained(study, state, min(moved, key=lambda r: r.fitted.score), there)
    ranked = in_order([*done.ranked, *moved], study.settings)
    step = replace(done, ranked=tuple(ranked))
    state = replace(state, steps=(*state.steps[:-1], step))
    apart = [r for r in in_order([*moved, taken], study.settings) if r is taken or sound(study, r)]
    best = chosen(apart, state.plain, study.settings) or taken
    return state if best is taken else widened(state, step, best, best.fitted)


def _elsewhere(study: Study, law: Attachment) -> Iterator[Attachment]:
    """A law at each of the bodies that couplings join with its own, where that has the signals it needs."""
    model = study.problem.model
    groups = [[body.name for body in group] for group in joined_bodies(model)]
    for port in next((group for group in groups if law.port in group), []):
        other = attach(model, port, law.mechanism, label=law.label)
        if port != law.port and possible_form(study, other) and not study.beliefs.exclude(other):
            yield other


def _moved(study: Study, state: SearchState, taken: RankedCandidate, law: Attachment) -> RankedCandidate | None:
    """The hypothesis of ``state`` with ``law`` in the place of the one taken, from its values; None where it cannot be fitted."""
    before, parent = taken.candidate.attachment, state.steps[-1].parent
    study.working_on(f"refitting {law.prefix} in the place of {before.prefix}")
    start = renamed(state.current.values(), f"{before.prefix}.", f"{law.prefix}.")
    fitted = fit(study, (*parent.effects, law), [start], state.current.fits[0])
    return None if fitted is None else judged(replace(taken.candidate, attachment=law), parent, fitted, study.settings)


def _contained(
    study: Study, state: SearchState, moved: RankedCandidate, there: set[tuple[str, str]]
) -> list[RankedCandidate]:
    """The laws that a moved one contains at its port, where that goes farther than the law it came from.

    Seen: the dry friction of an arm, told as presliding at its gearbox (0.85): at the arm presliding does better, dry friction best.
    """
    law, parent, found = moved.candidate.attachment, state.steps[-1].parent, []
    farther = moved.fitted.score < state.current.score
    names = [n for n in law.mechanism.generalises if n in LIBRARY and (law.port, n) not in there] if farther else []
    for other in (attach(study.problem.model, law.port, LIBRARY[name]()) for name in names):
        study.working_on(f"refitting {other.prefix} in the place of {law.prefix}")
        fitted = None if study.beliefs.exclude(other) else refitted(study, (*parent.effects, other), moved.fitted)
        if fitted is not None:
            found.append(judged(replace(moved.candidate, attachment=other), parent, fitted, study.settings))
    return found
