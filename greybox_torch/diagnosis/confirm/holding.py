"""Effects hold if free runs of the validation experiments come out no worse with them; those that do not are taken back."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial

import numpy as np

from greybox_torch.diagnosis.confirm.beyond_free_runs import said_of_windows
from greybox_torch.diagnosis.confirm.far_better import Standing, far_better, judged_anew
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut, gain
from greybox_torch.diagnosis.confirm.joint_deviation import within_one_deviation
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.not_asked import without_what_free_runs_do_not_need
from greybox_torch.diagnosis.confirm.refitted_laws import chosen_by_free_runs, refitted_laws
from greybox_torch.diagnosis.confirm.same_everywhere import CHANCE, CHANCE_FAR_ABOVE, drifts, is_offset
from greybox_torch.diagnosis.confirm.simpler_laws import simplified
from greybox_torch.diagnosis.confirm.sizes import sizes
from greybox_torch.diagnosis.confirm.take_back import take_back_weakest
from greybox_torch.diagnosis.confirm.undone import not_undone
from greybox_torch.diagnosis.confirm.with_one_more import with_one_more
from greybox_torch.diagnosis.hypothesis.degenerate import degenerate
from greybox_torch.diagnosis.hypothesis.final import Final, as_windows_have_it
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.select.backward import drop, drop_superfluous
from greybox_torch.diagnosis.select.richer import as_one_law
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import or_else, result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment

Judged = tuple[SearchState, Mapping[str, Gain], Judgement, tuple[str, ...], bool]
"""What is left of a state, its gains, its free runs, what a reader has to know of it, and whether there was time to judge it."""

AS_GOOD = 0.9
"""Share of a law's gain from which an offset does as well."""

WINDOWS_STAND = (
    "Parameters are those of windows with start states of their own: fitted to whole records, the model came out worse on the validation "
    "experiments, as a free run that drifts bends the parameters to its drift."
)


def holding(
    study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain], judged: Judgement
) -> Judged:
    """What is left of a state once every effect that free runs do not bear out is taken back, the weakest first.

    Where the values that whole records led to do not hold, those of the windows may.
    """
    told: tuple[str, ...] = ()
    needed: frozenset[str] = frozenset()

    def places() -> Places:
        return NOWHERE if others is None else others.places(state.current)

    if others is not None and not gains:
        begun = state, judged
        fewer = partial(without_what_free_runs_do_not_need, study, state, others, judged)
        (state, judged), _ = or_else(fewer, lambda: begun)
    while state.effects:
        holds = judged.holds and _shown(state, others, judged)
        undone = _undone(study, state, gains, needed)
        empty = _empty(study, state, judged.augmented, gains) or undone or _drifting(study, state, judged)
        empty = empty or _within_disturbances(study, state, judged)
        if empty is None and holds and not judged.unstable:
            better_so, whole = or_else(partial(far_better, study, state, others, gains, judged), lambda: None)
            if better_so is None and whole:
                passed, whole = or_else(partial(passed_over, study, state, others, judged), lambda: None)
                if passed is not None:
                    return (*passed, (*told, chosen_by_free_runs(passed, state, judged)), True)
            if better_so is None:
                return state, gains, judged, told, whole
            state, gains, judged = better_so
            continue
        if empty is None:
            trial = partial(_better_by_windows, study, state, gains, judged, places())
            better, whole = or_else(trial, lambda: None) if holds else (trial(), True)
            if better is not None and _shown(state, others, better):
                return state, gains, better, (*told, WINDOWS_STAND), True
            if holds:
                return state, gains, judged, told, whole
        if not state.compared_without:
            state = result_of(drop_superfluous(study, state))
        if empty is not None and empty in state.prefixes:
            fewer = _without(study, state, empty)
            if empty == undone and holds and _far_worse(study, fewer, others, judged):
                needed |= {empty}
                continue
            state = fewer
        elif (completed := with_one_more(study, state, others, judged)) is not None:
            state, gains, judged = completed
            continue
        else:
            before, state = state, take_back_weakest(study, state, gains)
            told += said_of_windows(before, state, gains, judged, study.settings)
        if not state.effects:
            return state, {}, judged.without_effects(), told, True
        gains, judged = judged_anew(study, state, others, judged)
    return state, gains, judged, told, True


def passed_over(study: Study, state: SearchState, others: HeldOut | None, judged: Judgement) -> Standing | None:
    """The laws that free runs prefer of those that were passed over (:func:`refitted_laws`); None where something speaks against one."""
    found = refitted_laws(study, state, others, judged)
    if found is None:
        return None
    laws, gains, by_it = found
    against = _empty(study, laws, by_it.augmented, gains) or _undone(study, laws, gains, frozenset())
    against = against or _drifting(study, laws, by_it) or _within_disturbances(study, laws, by_it)
    stand = against is None and by_it.holds and not by_it.unstable
    return found if stand and _shown(laws, others, by_it) else None


def _shown(state: SearchState, others: HeldOut | None, judged: Judgement) -> bool:
    """Whether free runs show the effects or, where they are lost on every experiment, windows: by most of the held-out error."""
    if not judged.by_windows_alone:
        return True
    if others is None:
        return False
    removed = gain(others.fits(state.plain), others.fits(state.current))
    settings = others.study.settings
    return removed.share > settings.held_out_in_part and removed.errors_away > settings.held_out_beyond_chance


def _better_by_windows(
    study: Study, state: SearchState, gains: Mapping[str, Gain], judged: Judgement, places: Places
) -> Judgement | None:
    """The free runs with the values that windows have, where those hold better than ``judged`` and say something of the machine.

    Where every free run is lost, whole records say nothing of the values.
    """
    by_windows = judged.having(as_windows_have_it(state.current, study.settings, study.recorded), places)
    better = by_windows.better_than(judged) or (judged.by_windows_alone and by_windows.holds)
    return by_windows if better and _empty(study, state, by_windows.augmented, gains) is None else None


def _without(study: Study, state: SearchState, prefix: str) -> SearchState:
    """The state without an effect that says nothing, or with a law that it contains: without its peak, Stribeck friction is Coulomb's."""
    simpler = simplified(study, state, next(e for e in state.effects if e.prefix == prefix))
    if simpler is None:
        return result_of(drop(study, state, prefix))
    fewer = result_of(drop_superfluous(study, simpler))
    one = as_one_law(study, fewer)
    return fewer if one is fewer else result_of(drop_superfluous(study, one))


def _empty(study: Study, state: SearchState, augmented: Final, gains: Mapping[str, Gain]) -> str | None:
    """An effect whose parameters, fitted to whole records, say nothing about the machine.

    Deviations are asked only where held-out experiments do not show by themselves that zero is not as good: of two amplitudes that trade
    for one another, as the stiffness and the damping of a hard stop, neither may be determined. What they show is the effect as windows
    have it; where whole records leave next to nothing of that, or amplitudes that even together are chance, it proves nothing.
    """
    values, deviations, over_windows = augmented.values(), augmented.deviations(), state.current.values()
    for e in state.effects:
        vanished = _share_kept(study, e, over_windows, values) < study.settings.least_share_kept
        shown = not vanished and not within_one_deviation(augmented, e, study.surroundings)
        proven = not e.mechanism.essential and shown and _proven(gains.get(e.prefix), study.settings)
        if degenerate(e, study.surroundings, values, {} if proven else deviations) is not None:
            return e.prefix
    return None


def _drifting(study: Study, state: SearchState, judged: Judgement) -> str | None:
    """An offset that is another one in every experiment."""
    far = judged.left(False)[1] > study.settings.far_above_disturbances
    chance = CHANCE_FAR_ABOVE if far else CHANCE
    asked = (
        e.prefix
        for e in state.effects
        if drifts(state.current, judged.problem, study.surroundings[e.port], e, study.budget, judged.begun, chance)
    )
    return next(asked, None)


def _within_disturbances(study: Study, state: SearchState, judged: Judgement) -> str | None:
    """An offset, or a law beside which an offset did as well, where free runs leave hardly more than noise without it: a slow disturbance
    makes as much.

    Seen: a complete power transformer, 1.1 times the noise, told as a gain of its load or an offset of its losses (0.97). Of 2300 verdicts
    at hand every such finding of what was missing left 2.5 times the noise and more.
    """
    if not judged.left(False)[1] < study.settings.above_noise:
        return None
    return next((e.prefix for e in state.effects if _as_good_as_an_offset(state, e)), None)


def _as_good_as_an_offset(state: SearchState, effect: Attachment) -> bool:
    """Whether an effect is an offset, or one gained nearly as much when it was taken."""
    done = state.step_of(effect.prefix)
    least = np.inf if done is None or done.taken is None else AS_GOOD * done.taken.gain
    as_good = () if done is None else (r for r in done.ranked if r.gain >= least)
    return is_offset(effect.mechanism) or any(is_offset(r.candidate.attachment.mechanism) for r in as_good)


def _undone(study: Study, state: SearchState, gains: Mapping[str, Gain], needed: Collection[str] = ()) -> str | None:
    """The named effect, not most of the mismatch, of which the other laws' and the model's parameters undo most, if that is nearly all.

    It stands for something else, unless free runs have shown that it is ``needed``.
    """
    settings, by_effect = study.settings, sizes(study, state, gains)
    named = [e for e in state.effects if not e.mechanism.free and e.prefix not in needed]
    small = [e for e in named if not by_effect[e.prefix] >= settings.most_of_the_mismatch]
    left = {e.prefix: not_undone(state.current, e, study.surroundings) for e in small}
    least = min(left, key=lambda p: left[p], default=None)
    return least if least is not None and left[least] < settings.least_not_undone else None


def _far_worse(study: Study, fewer: SearchState, others: HeldOut | None, judged: Judgement) -> bool:
    """Whether free runs leave next to nothing of the mismatch with the effects of ``judged``, and as much as a finding is without one.

    Short windows may hide what an offset does beside friction; where a model is as complete as that, nothing else is missing for which one
    of its effects could stand. Seen: the bias of a crane's boom, taken back as undone, and its presliding with it: 18 % left, not 0.01 %.
    """
    least = study.settings.least_size
    if judged.left(True)[0] >= least:
        return False
    without = judged_anew(study, fewer, others, judged)[1] if fewer.effects else judged.without_effects()
    return without.left(bool(fewer.effects))[0] >= least


def _share_kept(study: Study, effect: Attachment, before: Mapping[str, float], after: Mapping[str, float]) -> float:
    """What is left of an effect's amplitudes, of the one that keeps most, from one estimate to another.

    One that was zero before has nothing to keep.
    """
    names = [f"{effect.prefix}.{n}" for n in effect.mechanism.amplitudes(study.surroundings[effect.port])]
    return max((abs(after[n]) / abs(before[n]) for n in names if before[n]), default=1.0)


def _proven(gain: Gain | None, settings: DiagnosisSettings) -> bool:
    """Whether held-out experiments show that an effect is there, and large enough for a finding."""
    return gain is not None and gain.errors_away > settings.held_out_beyond_chance and gain.size >= settings.least_size
