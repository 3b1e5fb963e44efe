"""Laws that contain the found ones, where held-out experiments show what few windows of the others leave open."""

from __future__ import annotations

from greybox_torch.diagnosis.confirm.held_out import HeldOut, gain
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.flexed import in_its_place, widened, wider_laws
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study


def with_wider_laws(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """The state with the law that contains an effect's law instead, where that predicts other experiments better by what a finding is.

    Of two laws the simpler one was taken where the estimation experiments show no difference beyond chance, or a small one.
    """
    for effect, done, wider in list(wider_laws(study, state)):
        found = in_its_place(study, state, effect, done, wider)
        if found is not None and _farther(study, state, found, others):
            state = widened(state, done, wider, found)
            yield state
            return (yield from drop_superfluous(study, state))
    return state


def _farther(study: Study, state: SearchState, found: Hypothesis, others: HeldOut) -> bool:
    """Whether a hypothesis predicts held-out experiments better than that of a state, beyond chance and by the size of a finding."""
    plain, before, after = (others.fits(h) for h in (state.plain, state.current, found))
    beyond_chance = gain(before, after).errors_away > study.settings.held_out_beyond_chance
    return beyond_chance and size(plain, before, after, study.settings) >= study.settings.least_size
