"""What stands in the place of effects where free runs of the validation experiments leave far less with it.

No worse than the model as it stands is not enough: laws that took up what a right one lacks may undo most of what that one brings, and a
curve that goes farther over windows may go astray where a record leaves the range that it was learned over.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from greybox_torch.diagnosis.confirm.curves_for_names import curves_for_names
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.take_back import held_out_gains, take_back_weakest
from greybox_torch.diagnosis.confirm.too_little import removes_too_little
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.diagnosis.study import Study

Standing = tuple[SearchState, Mapping[str, Gain], Judgement]
"""A state, what its effects gain on held-out experiments, and its free runs."""


def far_better(
    study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain], judged: Judgement
) -> Standing | None:
    """Names in the place of a free curve, curves in that of several names, or what is left without the weakest of several effects, where
    free runs leave far less with it.

    None where neither does, or where too little is left to ask.
    """
    settings = study.settings
    if others is None:
        return None
    left = judged.left(True)[0]
    if state.has_curve and state.named is not None and left > settings.left_to_doubt_a_curve:
        names = replace(state.named, plain=state.plain, named=None)
        found = _standing(study, result_of(drop_superfluous(study, names)), state, others, judged)
        if found is not None:
            return found
    curves = curves_for_names(study, state, judged)
    found = None if curves is None else _standing(study, curves, state, others, judged)
    if found is not None:
        return found
    if len(state.effects) < 2 or not left > settings.left_to_doubt_of_several:
        return None
    if not state.compared_without:
        state = result_of(drop_superfluous(study, state))
    return _standing(study, take_back_weakest(study, state, gains), state, others, judged)


def _standing(
    study: Study, other: SearchState, state: SearchState, others: HeldOut, judged: Judgement
) -> Standing | None:
    """``other`` if its free runs leave far less than those of ``judged``, and windows bear all of its effects out beyond chance; else None.

    Where ``state`` removes too little to be told, it is enough that ``other`` removes more than that. Seen: a bump along an arm's speed,
    whose curve one free run does not follow; a mode, which no window bears out, left a quarter of that. The lag of a fan, beside which the
    waves of a pivot undid all that it brings: both were taken back, and the lag alone leaves 55 % of the mismatch.
    """
    if not other.effects:
        return None
    settings = study.settings
    by_it = free_runs_of(study, other, others, judged)
    far = _leave_far_less(by_it, judged.mismatch(True), settings)
    if not far and removes_too_little(state, judged, settings):
        far = _stand(by_it) and not removes_too_little(other, by_it, settings)
    return _where_borne_out(other, others, by_it, settings) if far else None


def leaving_far_less(
    study: Study,
    state: SearchState,
    others: HeldOut,
    judged: Judgement,
    than: Callable[[Judgement], float],
    compared: Callable[[SearchState], SearchState] = lambda state: state,
) -> Standing | None:
    """``state``, what its effects gain and its free runs, where those hold and leave far less than a mismatch, and held-out windows bear
    all effects out beyond chance; None elsewhere. Windows, which take longest, are asked last.

    Args:
        than: that mismatch, of the free runs.
        compared: completes the state with what windows compare it with, once they are asked.
    """
    by_it = free_runs_of(study, state, others, judged)
    if not _leave_far_less(by_it, than(by_it), study.settings):
        return None
    return _where_borne_out(compared(state), others, by_it, study.settings)


def _where_borne_out(
    state: SearchState, others: HeldOut, by_it: Judgement, settings: DiagnosisSettings
) -> Standing | None:
    """A state with its gains and free runs, where held-out windows bear all of its effects out beyond chance; else None."""
    gains = held_out_gains(state, others)
    sure = all(g.errors_away > settings.held_out_beyond_chance for g in gains.values())
    return (state, gains, by_it) if sure else None


def _leave_far_less(by_it: Judgement, than: float, settings: DiagnosisSettings) -> bool:
    """Whether free runs hold and leave far less than the mismatch ``than``."""
    return _stand(by_it) and by_it.mismatch(True) <= settings.left_if_far_better * than


def _stand(by_it: Judgement) -> bool:
    return bool(by_it.holds and not by_it.unstable)


def free_runs_of(study: Study, state: SearchState, others: HeldOut | None, judged: Judgement) -> Judgement:
    """The free runs of a state, its hypothesis fitted to whole records, beside the plain refit of ``judged``."""
    final = finish(state.current, study.settings, study.budget, study.recorded)
    if others is None:
        return judged.having(final)
    others.fits(state.current)  # which tell where positions begin that no sensor shows
    return judged.having(final, others.places(state.current))


def judged_anew(
    study: Study, state: SearchState, others: HeldOut | None, judged: Judgement
) -> tuple[Mapping[str, Gain], Judgement]:
    """What the effects of a state gain on held-out experiments, and its free runs (:func:`free_runs_of`).

    What one of several effects accounts for, others may take over once it is gone.
    """
    by_it = free_runs_of(study, state, others, judged)
    return ({} if others is None else held_out_gains(state, others)), by_it
