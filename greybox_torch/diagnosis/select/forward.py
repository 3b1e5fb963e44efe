"""Effects are taken one at a time while it pays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise, times_noise
from greybox_torch.diagnosis.hypothesis.mismatch import negligible
from greybox_torch.diagnosis.hypothesis.significance import window_significance
from greybox_torch.diagnosis.screen.shortlist import identity_of
from greybox_torch.diagnosis.select.as_two_laws import as_two_laws
from greybox_torch.diagnosis.select.at_joined_bodies import at_joined_bodies
from greybox_torch.diagnosis.select.choice import alone_at_noise, chosen, least_gain
from greybox_torch.diagnosis.select.finer_steps import in_finer_steps
from greybox_torch.diagnosis.select.flexed import flexed
from greybox_torch.diagnosis.select.forward_step import forward_step, little_is_left, take_best
from greybox_torch.diagnosis.select.memory import completed_by_memory
from greybox_torch.diagnosis.select.memory_for_lags import with_memory_for_lags
from greybox_torch.diagnosis.select.remaining import completes, little_things_are_missing
from greybox_torch.diagnosis.select.richer import richer_instead, with_earlier_law_richer, with_richer_form
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.select.two_laws import second_step, with_first_of_two
from greybox_torch.diagnosis.stopping import Stage, only_if
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.model.joined_bodies import joined_bodies


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
        state = yield from with_richer_form(study, state)
        taken = state.steps[-1]
        if taken.taken is not None and taken.taken.unknown and not _stands_again(study, state):
            state = yield from _named_instead(study, before, state)
            if len(state.effects) == len(taken.parent.effects):
                break  # what is there already comes as far as the curve, and no name goes farther
    return state


def _done(study: Study, state: SearchState) -> bool:
    """Whether noise alone is left, or so little that no effect can be a finding and the model is as complete as can be seen."""
    settings = study.settings
    if negligible(study, state.plain):
        return True
    complete = little_is_left(study, state) and completes(state.current, settings)
    return complete or only_noise(study.problem, state.current, settings)


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
    first = with_first_of_two(study, start, with_curve)
    if first is not None:
        two = yield from only_if(second_step(study, first), partial(_as_far, study, with_curve))
        if _as_far(study, with_curve, two):
            return replace(richer_instead(study, first, two) or two, found_before=start.found_before)
    name = _name_before_fine_curve(study, start, with_curve)
    if name is not None and _as_far(study, with_curve, name):
        return name
    branch = yield from only_if(_without_curves(study, start, with_curve), partial(_as_far, study, with_curve))
    if _as_far(study, with_curve, branch):
        return branch
    pieces = _in_pieces(study, with_curve, branch) or _many(study, with_curve, branch)
    standing = _before_pieces(start, with_curve, branch) if pieces else branch
    if standing is None or len(standing.effects) <= len(done.parent.effects):
        return replace(with_curve, plain=branch.plain)
    return replace(with_curve, plain=branch.plain, named=replace(standing, named=None))


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


def _before_pieces(start: SearchState, with_curve: SearchState, branch: SearchState) -> SearchState | None:
    """What to ask of names that are pieces of a curve, where that does not hold: those that went farther than the curve before others
    joined them, else the first one; None where the first step from ``start`` took none.

    Seen: a stage's constant force and dry friction went farther than the curve; with a ripple and a stop beside them all four were pieces,
    and the constant force alone was told.
    """
    grown = list(_one_by_one(start, branch))
    farther = (s for s in grown[:-1] if s.current.score < with_curve.current.score)
    return next(farther, grown[0] if grown else None)


def _one_by_one(start: SearchState, branch: SearchState) -> Iterator[SearchState]:
    """``branch`` after each of its steps from ``start`` that took an effect."""
    for count in range(len(start.steps) + 1, len(branch.steps) + 1):
        steps = branch.steps[:count]
        if steps[-1].taken is None:
            return
        yield replace(branch.at(steps[-1].taken.fitted), steps=steps)


def _without_curves(study: Study, start: SearchState, with_curve: SearchState) -> Stage[SearchState]:
    """The best named candidate of the step that took a curve, and what joins it if it brings a part of what the curve does."""
    done = with_curve.steps[-1]
    names = [r for r in done.ranked if not r.unknown]
    branch = yield from take_best(study, start, done.screened, names)
    if branch.took_one:
        branch = yield from with_richer_form(study, branch)
    reached, ceiling = _gains(with_curve, branch)
    if not branch.took_one or reached < study.settings.first_name_share * ceiling:
        return branch
    return (yield from take_effects(study, branch, curves=False, hopeful=partial(_within_reach, study, with_curve)))


def _within_reach(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether names may come as far as the curve, if each further one gains what the newest did.

    The first one says nothing of that: two laws may need one another. Later ones seldom gain more than those before them.
    """
    if len(_added(with_curve, branch)) < 2:
        return True
    reached, ceiling = _gains(with_curve, branch)
    newest = branch.steps[-1].parent.score - branch.current.score
    further = study.budget.most_effects - len(branch.effects)
    return reached + further * newest >= study.settings.named_share * ceiling


def _gains(with_curve: SearchState, branch: SearchState) -> tuple[float, float]:
    """What named effects gain and what the curve does, from the hypothesis that both build on."""
    before = with_curve.steps[-1].parent.score
    return before - branch.current.score, before - with_curve.current.score


def _in_pieces(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether named effects at the curve's port are pieces of it, and none is the machine's.

    True where there are more than ``most_names_for_curve`` of them. Also true where two, there or at a body that springs join with it,
    depend on the curve's own signal, which can draw any smooth curve between them, and the curve still removes, beyond chance, some of
    what they leave.
    """
    done, settings = with_curve.steps[-1], study.settings
    curve = None if done.taken is None else done.taken.candidate.attachment
    if curve is None:
        return False
    added = _added(with_curve, branch)
    if sum(e.port == curve.port for e in added) > settings.most_names_for_curve:
        return True
    near = _joined_with(study, curve.port)
    added = [e for e in added if e.port in near]
    if len(added) < 2 or not all(getattr(curve.mechanism, "signal", None) in e.mechanism.needs for e in added):
        return False
    further = partial(window_significance, branch.current, with_curve.current, settings)
    return with_curve.current.score < branch.current.score and further() > settings.least_significance


def _joined_with(study: Study, port: str) -> set[str]:
    """A port and, where it is a body, the bodies that springs join with it: at either end of a spring a force does nearly the same."""
    groups = ({body.name for body in group} for group in joined_bodies(study.problem.model))
    return next((group for group in groups if port in group), {port})


def _as_far(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether the effects of ``branch`` come as far as the curve of ``with_curve``, from the hypothesis that both build on.

    More than ``most_names_for_curve`` of them have to come farther: what one curve at one place explains is simpler than as many laws at
    several. Seen: the heat that shear makes in an extruder, a curve beside which a sensor's gain, a constant, an input's offset and a lag
    were told, each by its name and each wrong.
    """
    if _in_pieces(study, with_curve, branch):
        return False
    settings, (reached, ceiling) = study.settings, _gains(with_curve, branch)
    if _many(study, with_curve, branch):
        return reached >= ceiling + settings.curve_margin
    near = ceiling - settings.curve_margin
    if reached >= near or reached < settings.named_share * ceiling:
        return reached >= near
    return not alone_at_noise(with_curve.current, branch.current, with_curve.plain, settings)


def _many(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether ``branch`` has more effects in the place of the curve than ``most_names_for_curve``, wherever they are."""
    return len(_added(with_curve, branch)) > study.settings.most_names_for_curve


def _added(with_curve: SearchState, branch: SearchState) -> list[Attachment]:
    """The effects of ``branch`` that stand in the place of the curve."""
    return [e for e in branch.effects if e not in with_curve.steps[-1].parent.effects]
