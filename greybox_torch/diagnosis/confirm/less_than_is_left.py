"""Effects that are parts of what free runs leave with all of them, far above the noise.

A machine of which every law is a little richer than the model's leaves several times the noise of a good sensor. Of that some laws take a
tenth or a fifth each. None of them is what makes the mismatch, whatever they are. What a larger law lacks is such a part, too.
"""

from __future__ import annotations

from collections.abc import Mapping

from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.too_little import points_gained
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings


def less_than_is_left(
    state: SearchState, sizes: Mapping[str, float], judged: Judgement, settings: DiagnosisSettings
) -> dict[str, str]:
    """Why effects are refinements, a clause each: they account for less than what free runs of the validation experiments leave with all of
    them.

    That holds far above the noise, where the fit hardly rises with all of them. Seen: eleven small laws that a complete strut had and its
    model did not, told as an end stop (0.97), 19 % of the mismatch, and three more; validation 97.7 to 98.3 %, 53 % left. And what is
    little beside a larger effect, more than noise left, has to account for some times as much. Seen: a centrifuge's drag, 86 % of the
    mismatch, and a rubber mount's hysteresis (0.85), 3.3 %, where 2.8 % was left, 24 times the noise: more of the drag's law.

    Args:
        sizes: by effect, the share of the mismatch that it accounts for.
    """
    if not state.effects or judged.by_windows_alone:
        return {}
    share, times, _ = judged.left(True)
    left = f"free runs leave {digits(100 * share)} % with all that was found"
    parts: dict[str, str] = {}
    if times > settings.far_above_noise and points_gained(judged) < settings.least_points_of_curve:
        why = f"{left}, which is more, and the fit hardly rises: it may be one of many small parts of that"
        parts |= {prefix: why for prefix in state.prefixes if sizes[prefix] < share}
    if times > settings.above_noise:
        why = f"{left}, and beside a larger effect it may be what that one lacks"
        parts |= dict.fromkeys(_little_beside_a_larger_one(sizes, share, settings), why)
    return parts


def _little_beside_a_larger_one(sizes: Mapping[str, float], share: float, settings: DiagnosisSettings) -> set[str]:
    """The effects that may be what a larger one lacks, where free runs leave a ``share`` of the mismatch."""
    least = min(settings.least_times_what_is_left * share, settings.least_size_beside_larger, max(sizes.values()))
    return {prefix for prefix, size in sizes.items() if size < least}
