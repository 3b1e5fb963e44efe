"""Which effects the data ask for: one at a time while it pays, each tried without, doubtful ones chosen once more."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.choice import LEAST_GAIN
from greybox_torch.diagnosis.select.explore import explore, priced_score
from greybox_torch.diagnosis.select.forward import take_effects
from greybox_torch.diagnosis.select.forward_step import forward_step
from greybox_torch.diagnosis.select.posterior import shared
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage, result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment

MOST_REVISIONS = 2

BEYOND_DOUBT = 0.95
"""Probability from which an effect is not chosen once more when others have been found."""


def search(study: Study, state: SearchState) -> Stage[SearchState]:
    """Search until nothing pays any more. Every state that it yields can be answered with; see :mod:`greybox_torch.diagnosis.stopping`."""
    state = yield from explore(study, state)
    state = yield from drop_superfluous(study, state)
    for _ in range(MOST_REVISIONS):
        before = state
        state = yield from revise(study, before)
        if state.current is before.current:
            break
        state = yield from take_effects(study, state)
        state = yield from drop_superfluous(study, state)
    return state


def revise(study: Study, state: SearchState) -> Stage[SearchState]:
    """Choose doubtful effects but the newest once more, beside the others: an early choice was made while those were still missing.

    Once one is replaced, the rest is left as it is; where none is, the hypothesis is the same as before.
    """
    for effect in state.effects[:-1]:
        if beyond_doubt(state, effect):
            continue
        study.working_on(f"choosing {effect.prefix} once more")
        other = result_of(forward_step(study, state.at(state.without[effect.prefix])))
        pays = other.took_one and priced_score(other.current) < priced_score(state.current) + LEAST_GAIN
        if pays and effect.prefix not in other.prefixes:
            yield other
            return (yield from drop_superfluous(study, other))
        state = replace(state, plain=other.plain, steps=other.steps if pays else state.steps)
    return state


def beyond_doubt(state: SearchState, effect: Attachment) -> bool:
    """Whether no rival came near an effect in the step that took it."""
    done = state.step_of(effect.prefix)
    return done is not None and done.taken is not None and shared(done.taken, done.ranked)[0] > BEYOND_DOUBT
