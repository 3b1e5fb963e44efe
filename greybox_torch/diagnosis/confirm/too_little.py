"""Effects that leave nearly all of the mismatch: they are not what makes it."""

from __future__ import annotations

from collections.abc import Mapping

from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.comparison import mean_fit


def without_too_little(
    state: SearchState, gains: Mapping[str, Gain], judged: Judgement, settings: DiagnosisSettings
) -> tuple[tuple[SearchState, Mapping[str, Gain], Judgement], tuple[str, ...]]:
    """The state without its effects, and why, where free runs of the validation experiments leave nearly all of the mismatch with them and
    much more than the noise; else as it is. A free curve, which draws a part of anything, has to remove most of it, or to be seen
    in the fit.

    Seen: the clock of a logger that skips, told as a sensor's lag or gain (0.54), which left 91 % of a pendulum's mismatch; a pendulum with
    all known friction, told as unknown at its pivot (0.97), validation 94.2 to 94.7 %. So is what leaves most of it where the fit does not
    rise, however little the noise leaves of it: a complete hoist's rope, told as one that stiffens (0.97), 1.1 times the noise without it
    and with it.
    """
    if not removes_too_little(state, judged, settings):
        return (state, gains, judged), ()
    share, times, _ = judged.left(True)
    removed = max(100.0 * (1.0 - share), 0.0)
    why = (
        f"Taken back: free runs of the validation experiments leave all but {removed:.0f} % of the mismatch with what windows bear out, "
        f"{digits(times)} times the noise: it is not what makes the mismatch."
    )
    return (state.at(state.plain), {}, judged.without_effects()), (why,)


def removes_too_little(state: SearchState, judged: Judgement, settings: DiagnosisSettings) -> bool:
    """Whether free runs of the validation experiments leave nearly all of the mismatch with effects, and much more than the noise, or most
    of it where their fit does not rise."""
    if not state.effects or judged.by_windows_alone:
        return False
    share, times, _ = judged.left(True)
    hardly_seen = (
        all(e.mechanism.free for e in state.effects) and points_gained(judged) < settings.least_points_of_curve
    )
    if share > settings.most_of_the_mismatch and points_gained(judged) <= 0.0:
        return True
    least = settings.least_removed_by_curve if hardly_seen else settings.least_removed
    return share > 1.0 - least and times > settings.far_above_noise


def points_gained(judged: Judgement) -> float:
    """By how many points the mean fit of the validation experiments rises with the effects."""
    refit, with_effects = (mean_fit(judged.judging(c).scores) for c in (judged.refit, judged.with_effects))
    return with_effects - refit
