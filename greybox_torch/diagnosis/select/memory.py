"""Where neither laws nor curves reach the noise: whether what is missing depends on the past, or on two signals at once.

A residual with one or two hidden states follows any law that is linear, and a little of the others. So it is asked for late, and only where
more than noise is left. Alone it takes the place of names as a curve does; beside names it has to complete the model. Where much more is
left, a curve may stand in front: that follows, in part, whatever rubs.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise, times_noise
from greybox_torch.diagnosis.hypothesis.mismatch import negligible
from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate, shortlist
from greybox_torch.diagnosis.select.choice import alone_at_noise
from greybox_torch.diagnosis.select.forward_step import little_is_left, take_best
from greybox_torch.diagnosis.select.offered import Place, memory_scores, place
from greybox_torch.diagnosis.select.remaining import completes, left_to_complete, remaining_share
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import Stage, result_of
from greybox_torch.diagnosis.study import Study


def completed_by_memory(study: Study, state: SearchState) -> Stage[SearchState]:
    """Once some names are found: the state with a linear residual alone in their place where that completes the model.

    Further names would then only be pieces of it. Asked once in a search; else the state with what was seen.
    """
    if state.memory is not None or len(state.effects) < study.budget.names_before_memory or not _asked(study, state):
        return state
    alone = linear_residual(study, state.at(state.plain), state)
    state = replace(state, plain=alone.plain, memory=alone)
    if alone.took_one and completes(alone.current, study.settings) and _goes_farther(study, state, alone):
        state = _in_place(state, alone)
        yield state
    return state


def with_memory(study: Study, state: SearchState) -> Stage[SearchState]:
    """The state with an unknown that remembers, in the place of what was found or beside it, where that pays; else as it is."""
    if not _asked(study, state):
        return state
    alone = state.memory or linear_residual(study, state.at(state.plain), state)
    much_is_left = far_above_noise(state.current, study.settings)
    alone = _curved_if_farther(study, alone, state) if much_is_left else alone
    state = replace(state, plain=alone.plain, memory=alone)
    if alone.took_one and _goes_farther(study, state, alone):
        state = _in_place(state, alone)
        yield state
    elif state.effects and not state.has_curve and len(state.effects) < study.budget.most_effects:
        beside = linear_residual(study, state, state)
        beside = _curved_if_farther(study, beside, state) if much_is_left else beside
        if beside.took_one and completes(beside.current, study.settings):
            state = beside
            yield state
    return state


def _asked(study: Study, state: SearchState) -> bool:
    """Whether more than noise is left, and more than a finding is; where nothing was found, so much that something is surely missing."""
    settings = study.settings
    least = settings.above_noise if state.effects else settings.far_above_noise
    return (
        not negligible(study, state.plain)
        and times_noise(study.problem, state.current, settings) > least
        and not little_is_left(study, state)
    )


def _in_place(state: SearchState, alone: SearchState) -> SearchState:
    """The residual instead of what was found, which is kept at hand for held-out experiments to prefer it; of a curve, the names for it.

    Seen: a positioning stage (EMPS), whose free runs follow dry friction and a constant force far better than either (93 % for 62 %).
    """
    found = None if not state.effects else state.named or replace(state, named=None)
    return replace(alone, memory=alone, named=found)


def _goes_farther(study: Study, state: SearchState, alone: SearchState) -> bool:
    """Whether the residual alone is as much better than all that was found as a curve must be than a name."""
    settings = study.settings
    reached, farther = (alone.plain.score - s.current.score for s in (state, alone))
    at_noise = alone_at_noise(alone.current, state.current, alone.plain, settings)
    much = farther > settings.curve_gain_ratio * reached or at_noise
    return not state.effects or (much and farther > reached + settings.curve_margin)


def linear_residual(study: Study, state: SearchState, standing: SearchState) -> SearchState:
    """The step from a state to a linear residual, which has to come as far as what stands."""
    return result_of(_step(study, state, standing))


def _curved_if_farther(study: Study, linear: SearchState, standing: SearchState) -> SearchState:
    """``linear`` or, where that leaves much more than noise, the step to a residual with a curve in front, if that goes farther."""
    before = linear.at(linear.steps[-1].parent)
    if linear.took_one and not far_above_noise(linear.current, study.settings):
        return linear
    among = _leading(study, linear)
    curved = result_of(_step(study, replace(before, steps=before.steps[:-1]), standing, study.budget.knots, among))
    least = study.settings.curve_margin if linear.took_one else 0.0
    return curved if curved.took_one and curved.current.score < linear.current.score - least else linear


def _leading(study: Study, linear: SearchState) -> set[Place]:
    """The ports and signals of the linear residuals that explain most in the screen at some window length."""
    some, best = study.budget.curves_with_memory, set()
    for at in linear.steps[-1].screened:
        first = sorted(at, key=lambda score: -score.explained)
        places = dict.fromkeys(place(score.attachment) for score in first)
        best |= set(list(places)[:some])
    return best


def _step(
    study: Study, state: SearchState, standing: SearchState, knots: int = 0, among: Collection[Place] | None = None
) -> Stage[SearchState]:
    """A step in which nothing but residuals with memory are offered; with ``knots``, those with a curve in front ``among`` some.

    Only the few are refitted that by the screen may come as far as what stands: their refits are slow.
    """
    screened = memory_scores(study, state, knots, among)
    found: list[Candidate] = []
    for form in dict.fromkeys(_form(score) for at in screened for score in at):
        found += shortlist(study, [[s for s in at if _form(s) == form] for at in screened], state.current.fits)
    least = study.settings.curve_promise * _share_to_remove(study, state, standing)
    hopeful = [candidate for candidate in found if candidate.explained > least]
    best = sorted(hopeful, key=lambda candidate: -candidate.explained)[: study.budget.finalists]
    ranked = rank(study, state.current, best, standing.current)
    if state.effects and all(far_above_noise(r.fitted, study.settings) for r in ranked):
        # It would have to complete the model: polishing does not lead there from so far, and takes long.
        step = SelectionStep(screened, state.current, tuple(ranked), None)
        return replace(state, steps=(*state.steps, step))
    return (yield from take_best(study, state, screened, ranked))


def _form(score: ScreenScore) -> tuple[str, int]:
    """Which form of a residual was screened: each is asked by itself, as those with many parameters explain more in a screen."""
    mechanism = score.attachment.mechanism
    return mechanism.name, getattr(mechanism, "modes", 0)


def _share_to_remove(study: Study, state: SearchState, standing: SearchState) -> float:
    """The share of a state's squared error that has to go: beside laws all but the noise, alone all that what stands removes of it."""
    if state.effects:
        return left_to_complete(state.current, study.settings)
    return 1.0 - remaining_share(standing.plain, standing.current, study.settings) if standing.effects else 0.0
