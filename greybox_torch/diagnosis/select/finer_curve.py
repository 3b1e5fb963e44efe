"""Free curves drawn more finely: the one that was just taken, and those that tie for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.curve import finer
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.side_by_side import side_by_side


def with_finer_curve(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with its newest effect, a curve, drawn with twice the knots, and so on, as long as that pays and means anything.

    Where hardly more than noise is left, more knots draw that. Seen: the heat that a flow makes, which was set to some twenty values; of 28
    knots each had one or none, and on another experiment, with values between those, the curve made the error twelve times as large.
    """
    while _may_be_finer(study, state.current) and not _at_noise(study, state.current):
        drawn = state.current
        fitted = _drawn_finer(study, drawn)
        if fitted is None or fitted.score > drawn.score - study.settings.least_gain:
            break
        state = state.at(fitted)
        yield state
        if fitted.score >= drawn.score - study.settings.curve_margin:
            break
    return state


def with_tied_curves_finer(
    study: Study, parent: Hypothesis, ranked: Sequence[RankedCandidate]
) -> Sequence[RankedCandidate]:
    """The candidates, best first, with those curves drawn more finely that lead and tie, where they leave more than noise.

    What such curves leave is what few knots cannot draw, which says nothing of the place. Seen: a wing that stalls, told as a gain of the
    flow that falls with the wing's angle, for 0.05 in the logarithm of the error.
    """
    tied = [r for r in ranked if r.unknown and r.gain > ranked[0].gain - study.settings.curve_margin]
    tied = [r for r in tied if _may_be_finer(study, r.fitted)]
    if len(tied) < 2 or _at_noise(study, ranked[0].fitted):
        return ranked
    drawn = side_by_side(partial(_judged_finer, study, parent, r) for r in tied)
    rest = [r for r in ranked if all(r is not one for one in tied)]
    return in_order([*rest, *drawn], study.settings)


def as_fine_as_pays(study: Study, parent: Hypothesis, ranked: RankedCandidate) -> RankedCandidate:
    """A free curve, as it was compared with its parent, with twice the knots, and so on, as long as that pays and means anything."""
    while _may_be_finer(study, ranked.fitted):
        drawn = _judged_finer(study, parent, ranked)
        if drawn.gain < ranked.gain + study.settings.curve_margin:
            break
        ranked = drawn
    return ranked


def _judged_finer(study: Study, parent: Hypothesis, ranked: RankedCandidate) -> RankedCandidate:
    """A curve with twice the knots compared with the hypothesis before it; as it is where that is no better."""
    fitted = _drawn_finer(study, ranked.fitted)
    if fitted is None or fitted.score > ranked.fitted.score:
        return ranked
    return judged(replace(ranked.candidate, attachment=fitted.effects[-1]), parent, fitted, study.settings)


def _drawn_finer(study: Study, drawn: Hypothesis) -> Hypothesis | None:
    """The hypothesis with its newest effect, a curve, drawn with twice the knots."""
    study.working_on("drawing the curve more finely")
    attachment, values = finer(drawn, drawn.effects[-1], study.surroundings)
    effects = (*drawn.effects[:-1], attachment)
    return fit(study, effects, [values], drawn.fits[0], limits=study.budget.window_iterations)


def _at_noise(study: Study, fitted: Hypothesis) -> bool:
    return times_noise(study.problem, fitted, study.settings) <= study.settings.above_noise


def _may_be_finer(study: Study, drawn: Hypothesis) -> bool:
    curve = drawn.effects[-1].mechanism
    if not isinstance(curve, Unknown):
        return False  # a response with memory
    wanted = len(drawn.problem.free_names) + curve.knots
    return not curve.only_coarse and wanted < study.budget.most_parameters
