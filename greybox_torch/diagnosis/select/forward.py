"""Effects are taken one at a time while it pays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise, times_noise
from greybox_torch.diagnosis.hypothesis.mismatch import negligible
from greybox_torch.diagnosis.screen.shortlist import identity_of
from greybox_torch.diagnosis.select.as_two_laws import as_two_laws
from greybox_torch.diagnosis.select.at_joined_bodies import at_joined_bodies
from greybox_torch.diagnosis.select.choice import chosen, least_gain
from greybox_torch.diagnosis.select.finer_steps import in_finer_steps
from greybox_torch.diagnosis.select.flexed import flexed
from greybox_torch.diagnosis.select.forward_step import forward_step, little_is_left, take_best
from greybox_torch.diagnosis.select.memory import completed_by_memory
from greybox_torch.diagnosis.select.memory_for_lags import with_memory_for_lags
from greybox_torch.diagnosis.select.names_for_curve import (
    as_far_as_curve,
    before_pieces,
    gains,
    in_pieces,
    many_names,
    within_reach,
)
from greybox_torch.diagnosis.select.only_parts import only_parts
from greybox_torch.diagnosis.select.remaining import completes, little_things_are_missing
from greybox_torch.diagnosis.select.richer import richer_instead, with_earlier_law_richer, with_richer_form
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.select.two_laws import second_step, with_first_of_two
from greybox_torch.diagnosis.stopping import Stage, only_if
from greybox_torch.diagnosis.study import Study


def take_effects(
    study: Study,
    state: SearchState,
    *,
    curves: bool = True,
    hopeful: Callable[[SearchState], bool] = lambda state: True,
) -> Stage[SearchState]:
    """Forward steps while one pays; a free curve gives way to named effects that come as far.

    Args:
        curves: whether free curves are offered.
        hopeful: whether a further step may still change what is decided by the result.
    """
    while len(state.effects) < study.budget.most_effects and hopeful(state) and not _done(study, state):
        if curves:
            state = yield from completed_by_memory(study, state)
            state = yield from with_memory_for_lags(study, state)
        if _done(study, state):
            break
        if curves and little_things_are_missing(study, state):
            break
        before = state
        state = yield from forward_step(study, before, curves=curves)
        if not state.took_one and _fine_curves_may_help(study, state, curves) and not little_is_left(study, state):
            state = yield from forward_step(study, state, curves=curves, fine=True)
        if not state.took_one:
            richer = yield from with_earlier_law_richer(study, state)
            if richer is state:
                break
            state = richer
            continue
        state = at_joined_bodies(study, in_finer_steps(study, state))
        state = yield from as_two_laws(study, before, state)
        wider = flexed(study, before, state) or richer_instead(study, before, state)
        if wider is not None:
            state = wider
            yield state
            continue
        state = yield from _in_richer_form(study, state)
        taken = state.steps[-1]
        if taken.taken is not None and taken.taken.unknown and not _stands_again(study, state):
            state = yield from _named_instead(study, before, state)
            if len(state.effects) == len(taken.parent.effects):
                break  # what is there already comes as far as the curve, and no name goes farther
    return state


def _in_richer_form(study: Study, state: SearchState) -> Stage[SearchState]:
    """``state`` with its newest law in a richer form; one of another name or at another port is asked at joined bodies, too.

    Seen: the bristles of an arm's bearing, told at the gear (0.97), to which the form of a law at the motor had led.
    """
    richer = yield from with_richer_form(study, state)
    before, after = (s.steps[-1].taken for s in (state, richer))
    assert before is not None and after is not None
    other = before.candidate.attachment.named != after.candidate.attachment.named
    return at_joined_bodies(study, richer) if other else richer


def _done(study: Study, state: SearchState) -> bool:
    """Whether noise alone is left, or so little that no effect can be a finding and the model is as complete as can be seen, or whether all
    that was found are parts of something larger."""
    settings = study.settings
    if negligible(study, state.plain):
        return True
    complete = little_is_left(study, state) and completes(state.current, settings)
    return complete or only_parts(study, state) or only_noise(study.problem, state.current, settings)


def _fine_curves_may_help(study: Study, state: SearchState, curves: bool) -> bool:
    """Where nothing pays and yet more than noise is left, curves fine enough for a narrow law are tried."""
    times = times_noise(study.problem, state.current, study.settings)
    return curves and not state.has_curve and times > study.settings.above_noise


def _stands_again(study: Study, with_curve: SearchState) -> bool:
    """Whether a search with fewer experiments came to the same curve, and it leaves hardly more than noise here as well.

    Names have had their turn there: what could not follow the curve on fewer experiments does not on more.
    """
    found, curve = with_curve.found_before, identity_of(with_curve.effects[-1])
    known = found is not None and any(identity_of(effect) == curve for effect in found.effects)
    return known and completes(with_curve.current, study.settings)


def _named_instead(study: Study, before: SearchState, with_curve: SearchState) -> Stage[SearchState]:
    """Where a free curve was taken: the search without curves from where that step began, kept if named effects come as far.

    One curve can stand for several laws of the same signal, none of which would come near it alone.
    """
    done = with_curve.steps[-1]
    start = replace(with_curve.at(done.parent), steps=before.steps, in_place_of=done)
    two = yield from _two_instead(study, start, with_curve)
    if two is not start:
        return two
    name = _name_before_fine_curve(study, start, with_curve)
    if name is not None and as_far_as_curve(study, with_curve, name):
        return name
    branch = yield from only_if(_without_curves(study, start, with_curve), partial(as_far_as_curve, study, with_curve))
    if as_far_as_curve(study, with_curve, branch):
        return branch
    two = yield from _two_instead(study, start, with_curve, line_open=False)
    if two is not start:
        return two
    pieces = in_pieces(study, with_curve, branch) or many_names(study, with_curve, branch)
    standing = before_pieces(start, with_curve, branch) if pieces else branch
    if standing is None or len(standing.effects) <= len(done.parent.effects):
        return replace(with_curve, plain=branch.plain)
    return replace(with_curve, plain=branch.plain, named=replace(standing, named=None))


def _two_instead(
    study: Study, start: SearchState, with_curve: SearchState, *, line_open: bool = True
) -> Stage[SearchState]:
    """``start`` with two laws that draw the curve together, where they come as far; as it is elsewhere.

    That one of them may be a straight line is asked last: beside a law that comes as far alone, it would take up what is imprecise.
    """
    first = with_first_of_two(study, start, with_curve, line_open=line_open)
    if first is None:
        return start
    two = yield from only_if(second_step(study, first), partial(as_far_as_curve, study, with_curve))
    if not as_far_as_curve(study, with_curve, two):
        return start
    return replace(richer_instead(study, first, two) or two, found_before=start.found_before)


def _name_before_fine_curve(study: Study, start: SearchState, with_curve: SearchState) -> SearchState | None:
    """``start`` with the best name of the step before the one that took a curve; None where that step took an effect, or had no name.

    Of a few windows no name may be sure by itself. Fine curves are offered then, and if one is sure, something is there beyond chance.
    """
    if len(with_curve.steps) < 2:
        return None
    before, done = with_curve.steps[-2:]
    if before.taken is not None or before.parent.effects != done.parent.effects:
        return None
    name = chosen([r for r in before.ranked if not r.unknown], start.plain, study.settings)
    if name is None or name.gain < least_gain(name.fitted, study.settings):
        return None
    return replace(start.at(name.fitted), steps=(*start.steps, replace(before, taken=name)))


def _without_curves(study: Study, start: SearchState, with_curve: SearchState) -> Stage[SearchState]:
    """The best named candidate of the step that took a curve, and what joins it if it brings a part of what the curve does."""
    done = with_curve.steps[-1]
    names = [r for r in done.ranked if not r.unknown]
    branch = yield from take_best(study, start, done.screened, names)
    if branch.took_one:
        branch = yield from with_richer_form(study, branch)
    reached, ceiling = gains(with_curve, branch)
    if not branch.took_one or reached < study.settings.first_name_share * ceiling:
        return branch
    return (yield from take_effects(study, branch, curves=False, hopeful=partial(within_reach, study, with_curve)))
