"""Named laws in the place of a free curve that held-out experiments do not bear out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.confirm.held_out import HeldOut, gain
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.mismatch import mismatch_share
from greybox_torch.diagnosis.hypothesis.significance import over_the_same_windows
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.choice import least_gain
from greybox_torch.diagnosis.select.compare import compare
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study


def second_choice(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """``state``, of which nothing was left, with the best name that a refuted curve stood before, if held-out experiments bear that out.

    A curve of many knots follows one record farther than any law, and may say nothing of the next one. The laws that were refitted beside
    it were never asked. Here the held-out experiments decide: what few windows of the estimation experiments show (a tank that runs over
    twice) is confirmed by them or not. Only where the error is far above the noise everywhere, so that something is missing in any case.
    """
    done = _up_to_curve(state)
    if not done or not _plainly_missing(study, state, others):
        return state
    study.working_on("asking held-out experiments about named laws in the place of a curve")
    screened = done[-1].screened
    own = [step for step in reversed(done) if over_the_same_windows(step.parent, state.plain)]
    names = [r for step in own for r in step.ranked if _pays(study, r)]
    compared = compare(study, state.plain, screened, names)
    best = _surest(study, compared.ranked)
    if best is None:
        return state
    found = gain(others.fits(compared.parent), others.fits(best.fitted))
    if found.errors_away <= study.settings.held_out_beyond_chance:
        return state
    step = SelectionStep(screened, compared.parent, compared.ranked, best)
    named = SearchState(compared.parent, best.fitted, (*state.steps, step))
    yield named
    return (yield from drop_superfluous(study, named))


def _up_to_curve(state: SearchState) -> list[SelectionStep]:
    """The steps beyond the model as it stands, up to the one that took a curve; none where none did.

    A fine curve is compared alone: the names stood beside the coarse ones of the step before it.
    """
    steps = [s for s in state.steps if not s.parent.effects]
    taken = next((k for k, s in enumerate(steps) if s.taken is not None and s.taken.unknown), -1)
    return steps[: taken + 1]


def _pays(study: Study, ranked: RankedCandidate) -> bool:
    """Whether a named law explains something on the estimation experiments, and something of the machine."""
    return not ranked.unknown and sound(study, ranked) and ranked.gain > least_gain(ranked.fitted, study.settings)


def _surest(study: Study, ranked: Sequence[RankedCandidate]) -> RankedCandidate | None:
    """Of the laws that gain about as much as the best the one that most windows bear out: a larger gain may be of few windows."""
    paying = [r for r in ranked if _pays(study, r)]
    near = [r for r in paying if r.gain > study.settings.polish_share * paying[0].gain]
    return max(near, key=lambda r: r.significance, default=None)


def _plainly_missing(study: Study, state: SearchState, others: HeldOut) -> bool:
    """Whether the model as it stands leaves errors that anybody sees, far above the noise, on all experiments."""
    settings = study.settings
    least = min(times_noise(study.problem, state.plain, settings), float(np.min(others.times_noise(state.plain))))
    return mismatch_share(state.plain, settings) > settings.obvious_mismatch and least > settings.far_above_noise
