"""Effects that are parts of what free runs leave with all of them, far above the noise.

A machine of which every law is a little richer than the model's leaves several times the noise of a good sensor. Of that some laws take a
tenth or a fifth each. None of them is what makes the mismatch, whatever they are. What a larger law lacks is such a part, too.
"""

from __future__ import annotations

from collections.abc import Mapping

from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.too_little import points_gained
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings


def less_than_is_left(
    state: SearchState, sizes: Mapping[str, float], judged: Judgement, settings: DiagnosisSettings
) -> set[str]:
    """The effects that are refinements, as they account for less than what free runs of the validation experiments leave with all of them.

    None where that is not far above the noise. Where the fit rises clearly with the effects, those alone that are little beside a larger
    one, and account for a few times what is left at most. Seen: eleven small laws that a complete strut had and its model did not, told as
    an end stop (0.97), 19 % of the mismatch, and three more; validation 97.7 to 98.3 %, 53 % left. A centrifuge's drag, 86 % of the
    mismatch, and beside it a rubber mount's hysteresis (0.85), 3.3 %, where 2.8 % was left, 24 times the noise: more of the drag's law.

    Args:
        sizes: by effect, the share of the mismatch that it accounts for.
    """
    if not state.effects or judged.by_windows_alone:
        return set()
    share, times, _ = judged.left(True)
    if not times > settings.far_above_noise:
        return set()
    little = min(settings.least_times_what_is_left * share, settings.least_size_beside_larger)
    most = max(sizes[prefix] for prefix in state.prefixes)
    if points_gained(judged) >= settings.least_points_of_curve:
        return {prefix for prefix in state.prefixes if sizes[prefix] < min(little, most)}
    return {prefix for prefix in state.prefixes if sizes[prefix] < share or sizes[prefix] < min(little, most)}
