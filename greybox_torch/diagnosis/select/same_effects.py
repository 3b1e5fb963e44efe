"""The effects that a search with fewer experiments came to, estimated from one more, in the place of another search."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.refit.curve import over_its_range
from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.forward_step import take_best
from greybox_torch.diagnosis.select.found_before import available
from greybox_torch.diagnosis.select.remaining import remaining_share
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.select.undecided import listed, undecided
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def with_same_effects(study: Study, begun: SearchState, before: SearchState) -> SearchState:
    """``begun`` with the effects of ``before``, and the steps that chose them; as it is where they leave as much as a finding is.

    An experiment that no free run follows is taken to choose with since it cannot score, one that tells rivals apart for those alone; what
    is there, the others have shown. Effects that are undecided are chosen once more among their rivals.
    """
    study.working_on("estimating what was found from one more experiment")
    effects, values = before.effects, before.current.values()
    curve = next((e for e in effects if e.mechanism.free), None)
    if curve is not None:
        if not available(study, curve):
            return begun
        drawn, values = over_its_range(before.current, curve, study.surroundings)
        effects = before.with_law(curve, drawn)
    fitted = refitted(study, effects, begun.current, [values])
    if fitted is None:
        return begun
    state = SearchState(begun.plain, fitted, before.steps)
    for effect in effects:
        state = _chosen_once_more(study, state, effect)
    enough = remaining_share(begun.plain, state.current, study.settings) < study.settings.least_size
    return state if enough else begun


def _chosen_once_more(study: Study, state: SearchState, effect: Attachment) -> SearchState:
    """The state with an undecided effect, or one of its rivals instead, as all experiments speak for; as it is where none is undecided."""
    done = state.step_of(effect.prefix)
    if done is None or done.taken is None or not undecided(study, state, effect):
        return state
    study.working_on(f"choosing {effect.prefix} once more")
    rest = tuple(e for e in state.effects if e.prefix != effect.prefix)
    parent = (refitted(study, rest, state.current) if rest else None) or state.plain
    laws = [r for r in (done.taken, *listed(study, state, effect)) if available(study, r.candidate.attachment)]
    offered = [_from_where_it_was(state, r) for r in laws]
    other = result_of(take_best(study, state.at(parent), done.screened, rank(study, parent, offered)))
    return other if other.took_one else state


def _from_where_it_was(state: SearchState, rival: RankedCandidate) -> Candidate:
    """A candidate of an earlier step with the values that its law had there, and those of ``state`` for all others, before its own.

    Without the windows at the card's values that it may have begun in: they are those of fewer experiments.
    """
    law = f"{rival.candidate.attachment.prefix}."
    own = {n: v for n, v in rival.fitted.values().items() if n.startswith(law)}
    return replace(rival.candidate, found_before=({**state.current.values(), **own},), at_card=(), begun=None)
