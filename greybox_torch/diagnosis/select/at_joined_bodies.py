"""The law of one body at the bodies that springs join with it.

At either end of a spring a force does nearly the same, and which end the screen offers is decided by tangents at the model as it stands.
What the wrong end leaves, some other law takes up. Seen: a stop of an arm, told as one of its gearbox (0.97) and, for what that left, as a
spring that stiffens (0.97); at the arm the stop alone leaves a fifth of the squared error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.possible_form import possible_form
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged, sound
from greybox_torch.diagnosis.refit.refitted import fit, polished, refitted
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

    Only at bodies where it is not there already. Where it had its turn in that step it is asked again, from the values of the one taken, if
    it came clearly less far: its own start values may have led to a local minimum. What was asked is a rival there in any case.
    """
    done = state.steps[-1]
    taken = done.taken
    if taken is None or taken.unknown or only_noise(study.problem, state.current, study.settings):
        return state
    ranked = {r.candidate.attachment.named: r for r in reversed(done.ranked)}  # of several forms the best
    asked = set(ranked) | {e.named for e in done.parent.effects}
    near = state.current.score + study.settings.score_tie
    done_with = {named for named in asked if named not in ranked or ranked[named].fitted.score < near}
    laws = [law for law in elsewhere(study, taken.candidate.attachment) if law.named not in done_with]
    moved = [found for law in laws if (found := _moved(study, state, taken, law)) is not None]
    moved = [r for r in moved if (own := ranked.get(r.candidate.attachment.named)) is None or _farther(r, own)]
    if not moved:
        return state
    farthest = min(moved, key=lambda r: r.fitted.score)
    moved += _contained(study, state, farthest, asked)
    own = taken
    if farthest.fitted.score < near and (further := converged(study, state.current)) is not state.current:
        own = judged(taken.candidate, done.parent, further, study.settings)
    again = {r.candidate.attachment.named for r in moved}
    others = [
        r for r in done.ranked if r.candidate is not taken.candidate and r.candidate.attachment.named not in again
    ]
    step = replace(done, ranked=tuple(in_order([*others, own, *moved], study.settings)))
    state = replace(state, steps=(*state.steps[:-1], step))
    apart = [r for r in in_order([*moved, own], study.settings) if r is own or sound(study, r)]
    best = chosen(apart, state.plain, study.settings) or own
    return state if best is taken else widened(state, step, best, best.fitted)


def _farther(moved: RankedCandidate, own: RankedCandidate) -> bool:
    """Whether a law goes farther from the values of another body's than it went by itself."""
    return moved.fitted.score < own.fitted.score


def elsewhere(study: Study, law: Attachment) -> Iterator[Attachment]:
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
    if fitted is None:
        return None
    if abs(fitted.score - state.current.score) < study.settings.polished_elsewhere:
        fitted = converged(study, fitted)
    return judged(replace(taken.candidate, attachment=law), parent, fitted, study.settings)


def converged(study: Study, fitted: Hypothesis) -> Hypothesis:
    """``fitted`` polished, also from the model's values on the card, until that hardly betters it.

    Along the valley of a law whose parameters make up for one another a refit ends early. Seen: a stop of an arm, of which three more
    refits removed as much as set it apart from one of its gearbox.
    """
    for _ in range(study.budget.most_polishes):
        before, fitted = fitted, polished(study, fitted, [{**fitted.values(), **study.card}])
        if fitted.score > before.score - study.settings.hardly_better:
            break
    return fitted


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
