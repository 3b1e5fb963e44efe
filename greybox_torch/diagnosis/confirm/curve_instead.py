"""A free curve in the place of nothing, or of little, where no name lasted that explains most and held-out experiments bear it out."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.confirm.far_better import Standing, leaving_far_less
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.significance import over_the_same_windows
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, sound
from greybox_torch.diagnosis.select.finer_curve import as_fine_as_pays
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.study import Study
from greybox_torch.simulation.side_by_side import side_by_side


def curve_instead(study: Study, state: SearchState, others: HeldOut | None, judged: Judgement) -> Standing | None:
    """The free curve that led the first step of ``state``, drawn as finely as pays, in the place of what was left of that; None where free
    runs do not leave half of what that leaves or less with it, or windows do not bear it out beyond chance.

    A name of many amplitudes may go farther than a curve of few knots, and what joins it takes up what it lacks. Seen: a dip and a bump of
    a rail, told as a ripple of six harmonics and a curve; neither lasted, and 56 times the noise was left without a name.
    """
    settings, step = study.settings, first_with_curves(study, state)
    if others is None or step is None or times_noise(study.problem, state.plain, settings) <= settings.above_noise:
        return None
    study.working_on("asking held-out experiments about a curve in the place of names")
    drawn = in_order(
        side_by_side(partial(as_fine_as_pays, study, step.parent, r) for r in curves_of(study, step)), settings
    )
    best = drawn[0]
    curve = replace(
        state.at(best.fitted),
        steps=(*state.steps, SelectionStep(step.screened, step.parent, tuple(drawn), best)),
        without={best.candidate.attachment.prefix: state.plain},
    )

    def left(by_it: Judgement) -> float:
        return judged.mismatch(True) if state.effects else by_it.mismatch(False)

    return leaving_far_less(study, curve, others, judged, left)


def first_with_curves(study: Study, state: SearchState) -> SelectionStep | None:
    """The first step, beside no effect, in which free curves gained more than chance."""
    asked = (*(() if state.in_place_of is None else (state.in_place_of,)), *state.steps)
    own = (s for s in asked if not s.parent.effects and over_the_same_windows(s.parent, state.plain))
    return next((s for s in own if curves_of(study, s)), None)


def curves_of(study: Study, step: SelectionStep) -> list[RankedCandidate]:
    """The free curves of a step that gain about as much as the best of them, and more than chance."""
    settings = study.settings
    found = [r for r in step.ranked if r.unknown and sound(study, r) and r.gain > settings.curve_margin]
    return [r for r in found if r.gain > settings.polish_share * found[0].gain]
