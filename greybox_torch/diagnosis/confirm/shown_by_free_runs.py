"""Effects that free runs show and windows hardly do.

Over a window the start states take up whatever acts slowly. What removes most of the error of free runs of experiments that had no part in
choosing, where that is more than disturbances make, is missing, however little of it windows see. Seen: an arm's friction that differs by
direction, 171 times the noise in free runs and 2.3 times with it, was a refinement, and nothing was missing (0.80), as it is but 12 % of
what windows leave. Of five blind proofs eight cases had refinements alone; all lacked something.
"""

from __future__ import annotations

from collections.abc import Mapping

from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.longer_windows import constant_effect
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def shown_by_free_runs(study: Study, state: SearchState, gains: Mapping[str, Gain], judged: Judgement) -> set[str]:
    """The effects, none too small for a finding, that held-out windows bear out beyond chance and that are the same in every experiment,
    where free runs need them.

    None where free runs leave what disturbances may make without the effects, or more than a quarter of that with them.
    """
    settings = study.settings
    _, times, _ = judged.left(False)
    share, _, _ = judged.left(True)
    if judged.unstable or not (times > settings.far_above_disturbances and share <= settings.slow_share):
        return set()
    asked = [e for e in state.effects if e.prefix in gains]
    large = [e for e in asked if not gains[e.prefix].size < settings.least_size]
    sure = [e for e in large if gains[e.prefix].errors_away > settings.held_out_beyond_chance]
    return {e.prefix for e in sure if constant_effect(study, state, judged, e)}
