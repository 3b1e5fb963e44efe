"""A search that takes one small part of the mismatch after another, and leaves more than any of them: none of them is what makes it."""

from __future__ import annotations

from greybox_torch.diagnosis.hypothesis.mismatch import mismatch_share
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def only_parts(study: Study, state: SearchState) -> bool:
    """Whether at least three effects each account for less of the mismatch than all of them leave, and the fit hardly rises with them.

    A machine of which every law is a little richer than the model's is such a case. What follows would be refinements of refinements, and
    each step costs as much as the first. Seen: a complete tape drive, 98 % of its motion explained: four laws in two minutes, all of which
    were taken back in the end.
    """
    settings = study.settings
    if len(state.effects) < settings.least_parts or study.more_is_missing:
        return False
    points = 100.0 * (mismatch_share(state.plain, settings) - mismatch_share(state.current, settings))
    if points >= settings.least_points_of_curve:
        return False
    left = 1.0 - size(state.plain.fits, state.plain.fits, state.current.fits, settings)
    return all(_share(study, state, prefix) < left for prefix in state.prefixes)


def _share(study: Study, state: SearchState, prefix: str) -> float:
    """The share of the mismatch that an effect took in its step; all of it where that is not on record."""
    done = state.step_of(prefix)
    if done is None or done.taken is None:
        return 1.0
    return size(state.plain.fits, done.parent.fits, done.taken.fitted.fits, study.settings)
