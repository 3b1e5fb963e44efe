"""An error above the noise that no effect explains: whether something is missing, or a disturbance acts that nobody measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.confirm.hardly_followed import hardly_followed
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.describe.residual_tests import Detection
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.mismatch import largest_share, least_mismatch, mismatch_share
from greybox_torch.diagnosis.hypothesis.noise import floor_known
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study

A_DISTURBANCE = (
    "What is left above the noise follows past inputs in small part at most, and no law, curve or response with memory of what the model "
    "knows of the motion explains it: it may be a disturbance that nobody measured, or many laws of the model that are each a little too "
    "simple. The same experiment twice would tell which: the latter repeats."
)


def error_without_a_name(study: Study, state: SearchState, others: HeldOut | None, judged: Judgement) -> float | None:
    """How many times the noise the model's error is on the worst experiment, if that is too much for badly determined friction.

    By windows of any experiment and by free runs: where either shows hardly more than noise, nothing says that anything is missing. Nor
    where the error is less than simulations of one machine differ by. Where the recordings show no more than an upper bound of the noise,
    that bound is counted only against errors that anybody sees. Where free runs hardly follow, windows need not show much.
    """
    settings = study.settings
    held_out = 0.0 if others is None else largest_share(others.fits(state.plain), settings)
    shares = (max(mismatch_share(state.plain, settings), held_out), judged.mismatch_share)
    if max(shares) < least_mismatch(study):
        return None
    lost = hardly_followed(judged)
    plain_to_see = lost or min(shares) > settings.obvious_mismatch
    errors = []
    if plain_to_see or floor_known(study.problem, settings):
        errors.append(times_noise(study.problem, state.plain, settings))
    if others is not None and (plain_to_see or floor_known(others.problem, settings)):
        errors += list(others.times_noise(state.plain))
    above = settings.above_noise if lost else settings.far_above_noise
    by_windows = max((e for e in errors if above < e < np.inf), default=0.0)
    least = min(by_windows, float(np.nanmax(judged.times_noise, initial=0.0)))
    return least if least > above else None


def is_missing(
    error: float | None,
    chosen_by: float,
    detected: Sequence[Detection],
    tried: bool,
    settings: DiagnosisSettings,
    lost: bool = False,
) -> bool:
    """Whether an error of so many times the noise, that nothing explains, says that something is missing.

    A disturbance that nobody measured leaves some times the noise as well, and so do laws that are all a little richer than the model's.
    Neither follows the inputs, by size and not only beyond chance, and no law explains it. What is missing from a model does, or is much
    larger, or was not looked for to the end, or where nobody looked.

    Args:
        error: from :func:`error_without_a_name`.
        chosen_by: how many times the noise it is on the experiments to choose with, over windows.
        tried: whether the search ended by itself, and nothing explained the error.
        lost: whether free runs hardly follow the validation experiments, see :func:`hardly_followed`.
    """
    if error is None:
        return False
    repeats = any(d.plain.past.beyond and d.plain.past.value >= settings.least_of_error_repeats for d in detected)
    looked_at = tried and error < settings.most_error_elsewhere * chosen_by
    return lost or not looked_at or repeats or error > settings.far_above_disturbances
