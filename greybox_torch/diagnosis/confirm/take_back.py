"""Held-out experiments judge the effects that the estimation experiments chose, and may take them back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from greybox_torch.diagnosis.confirm.coarser_curve import with_coarser_curve
from greybox_torch.diagnosis.confirm.exercised import hardly_exercised, untouched
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut, gain, timelines
from greybox_torch.diagnosis.confirm.second_choice import second_choice
from greybox_torch.diagnosis.confirm.simpler_laws import with_simpler_laws
from greybox_torch.diagnosis.confirm.standing import sharing_with_the_rest
from greybox_torch.diagnosis.confirm.wider_laws import with_wider_laws
from greybox_torch.diagnosis.hypothesis.same_lengths import over_same_lengths
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.refit.ranked import doubtful
from greybox_torch.diagnosis.select.backward import drop, drop_superfluous
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import Stage, result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulation.side_by_side import side_by_side


def confirm(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """Take back, weakest first, every effect that gains nothing on held-out experiments; a free curve gives way to names.

    Where nothing is left of those names, the curve is asked. Seen: a brake along a part of a rail, whose curve removed 46 % of the held-out
    error, 2.7 standard errors more than a mode that stood for it and removed none.
    """
    if not state.effects:
        return state
    study.working_on("confirming on held-out experiments")
    state = yield from with_coarser_curve(study, state, others)
    with_curve = state if state.has_curve else None
    state = yield from _names_for_curve(study, state, others)
    state = yield from with_simpler_laws(study, state, others)
    state = yield from with_wider_laws(study, state, others)
    state = yield from _what_is_borne_out(study, state, others)
    if not state.effects and with_curve is not None and with_curve.named is not None:
        state = yield from _what_is_borne_out(study, replace(with_curve, plain=state.plain, named=None), others)
    if not state.effects:
        state = yield from second_choice(study, state, others)
        state = yield from _what_is_borne_out(study, state, others)
    return state


def _what_is_borne_out(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """The state without the effects that held-out experiments take back, the weakest first."""
    while state.effects:
        taken_back = _to_take_back(study, state, held_out_gains(state, others), others)
        if taken_back is None:
            break
        state = yield from drop(study, state, taken_back)
    return state


def held_out_gains(state: SearchState, others: HeldOut) -> dict[str, Gain]:
    """By effect, what it gains on held-out experiments beside the others."""
    settings = others.study.settings
    plain, full, *without = side_by_side(
        partial(others.fits, h) for h in (state.plain, state.current, *state.without.values())
    )
    found = {}
    for prefix, fits in zip(state.without, without, strict=True):
        shown = gain(fits, full)
        size_there = size(plain, fits, full, settings)
        little = abs(shown.share) < settings.least_size
        small = len(state.effects) > 1 and shown.share > 0.0 and size_there < settings.least_size
        idle = False
        if little or small:
            there = others.fits_at(state.without[prefix], state.current.values())
            idle = little and untouched(there, full, settings)
            idle = idle or (small and hardly_exercised(others.study, state, prefix, there, full))
        found[prefix] = replace(shown, timelines=timelines(fits, full), size=size_there, untouched=idle)
    return found


def take_back_weakest(study: Study, state: SearchState, gains: Mapping[str, Gain]) -> SearchState:
    """Without the effect that gained least on held-out experiments (the newest where that is not known)."""
    names = [e.prefix for e in state.effects]
    weakest = min(names, key=lambda n: gains[n].share) if all(n in gains for n in names) else state.newest
    return result_of(drop(study, state, weakest))


def _names_for_curve(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """The named effects that were found in the place of a free curve, where that goes no farther on held-out experiments."""
    if state.named is None:
        return state
    plain, named, curve = side_by_side(
        partial(others.fits, h) for h in (state.plain, state.named.current, state.current)
    )
    farther = gain(named, curve).errors_away >= study.settings.held_out_beyond_chance
    if farther or goes_farther_in_most_windows(plain, named, curve, study.settings):
        return state
    curve = next((s for s in reversed(state.steps) if s.taken is not None and s.taken.unknown), None)
    named_state = replace(state.named.at(state.named.current), plain=state.plain, named=None, in_place_of=curve)
    yield named_state
    return (yield from drop_superfluous(study, named_state))


def goes_farther_in_most_windows(
    plain: Sequence[WindowFit], named: Sequence[WindowFit], curve: Sequence[WindowFit], settings: DiagnosisSettings
) -> bool:
    """Whether names reach less than ``named_share`` of what a curve does in the median held-out window, and the curve goes farther by the
    margin in four of five, at every length: at one at least with enough windows.

    Beyond the range that it was learned over a curve says nothing: one window that goes there must not decide against it.
    """
    most = 0
    for before, by_name, by_curve in over_same_lengths(plain, named, curve):
        energies = [fit.energies for fit in (before, by_name, by_curve)]
        if len({len(e) for e in energies}) > 1:
            return False
        start, reached, ceiling = (np.log(e + np.finfo(float).tiny) for e in energies)
        in_part = np.median(start - reached) < settings.named_share * np.median(start - ceiling)
        if not in_part or np.quantile(reached - ceiling, 0.2) < settings.curve_margin:
            return False
        most = max(most, len(start))
    return most >= settings.fewest_windows


def _to_take_back(study: Study, state: SearchState, gains: Mapping[str, Gain], others: HeldOut) -> str | None:
    """The weakest effect if it is not borne out, else one that is idle or does what the rest do; None where all stand."""
    weakest = min(gains, key=lambda p: gains[p].errors_away)
    settings = others.study.settings
    if not _borne_out(gains[weakest], settings.least_held_out, settings):
        return weakest
    left_open = [
        p
        for p, found in gains.items()
        if found.errors_away <= settings.least_held_out and _doubtful(state, p, settings)
    ]
    if left_open:
        return left_open[0]
    idle = _idle(state, gains, others.fits(state.current), others)
    return sharing_with_the_rest(study, state, others, gains) if idle is None else idle


def _doubtful(state: SearchState, prefix: str, settings: DiagnosisSettings) -> bool:
    """Whether windows left a law open, which then has to show on held-out experiments, and is not kept where they do not exercise it."""
    done = state.step_of(prefix)
    return done is not None and done.taken is not None and doubtful(done.taken, settings)


def _borne_out(gain: Gain, least: float, settings: DiagnosisSettings) -> bool:
    """Whether held-out experiments bear an effect out by so many standard errors, or do not exercise it."""
    return gain.errors_away > least or gain.unexercised(settings)


def _idle(state: SearchState, gains: Mapping[str, Gain], full: tuple[WindowFit, ...], others: HeldOut) -> str | None:
    """An effect that gains on held-out experiments only by what the other parameters became beside it, if there is one.

    A disturbance of one experiment (a slow drift) bends the other parameters; what takes it up there, say a bias, frees them, and so
    predicts other experiments better though it is not in them. Left out there, all else as it is, nothing is lost. Where few windows leave
    that open, an effect whose whole gain is beyond chance, or is all its own, is asked for no more than any effect is.
    """
    values, settings = state.current.values(), others.study.settings
    for prefix in (p for p, found in gains.items() if found.share < settings.held_out_in_part):
        own = gain(others.fits_at(state.without[prefix], values), full)
        proven = gains[prefix].errors_away > settings.held_out_beyond_chance
        all_its_own = own.share >= settings.held_out_in_part * gains[prefix].share
        least = settings.least_held_out if proven or all_its_own else settings.least_held_out_alone
        if not _borne_out(own, least, settings):
            return prefix
    return None
