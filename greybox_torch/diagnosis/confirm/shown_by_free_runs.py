"""Effects that free runs show and windows hardly do.

Over a window the start states take up whatever acts slowly. What removes most of the error of free runs of experiments that had no part in
choosing, where that is more than disturbances make, is missing, however little of it windows see. Seen: an arm's friction that differs by
direction, 171 times the noise in free runs and 2.3 times with it, was a refinement, and nothing was missing (0.80), as it is but 12 % of
what windows leave. Of five blind proofs eight cases had refinements alone; all lacked something.

An offset is also what a disturbance that nobody measured makes, up to some times the noise. A law that follows the motion is not: another
motion bears it out. Seen: a drag, 5.4 times the noise in free runs and 1.1 with it; a bearing's friction, 4.3 and 1.8; a spring's damping,
4.4 and 1.6: nothing was missing (0.80), as each is about half of the little that windows leave.
"""

from __future__ import annotations

from collections.abc import Mapping

from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.confirm.longer_windows import constant_effect
from greybox_torch.diagnosis.confirm.same_everywhere import is_offset
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.mechanism import Mechanism


def shown_by_free_runs(study: Study, state: SearchState, gains: Mapping[str, Gain], judged: Judgement) -> set[str]:
    """The effects, none too small for a finding, that held-out windows bear out beyond chance and that are the same in every experiment,
    where free runs need them.

    None where free runs leave what disturbances may make without the effects, or more than a quarter of that with them. Of a law that
    follows the motion, and that free runs of each of several validation experiments need, less is asked.
    """
    settings = study.settings
    _, times, _ = judged.left(False)
    share, _, _ = judged.left(True)
    if judged.unstable or not (times > settings.far_above_noise and share <= settings.slow_share):
        return set()
    far = times > settings.far_above_disturbances
    asked = [e for e in state.effects if e.prefix in gains and (far or not _may_be_a_disturbance(e.mechanism))]
    large = [e for e in asked if not gains[e.prefix].size < settings.least_size]
    in_each = not far and len(large) == 1 and _needed_in_each_of_several(judged, settings)
    least = settings.least_held_out if in_each else settings.held_out_beyond_chance
    sure = [e for e in large if gains[e.prefix].errors_away > least]
    return {e.prefix for e in sure if in_each or constant_effect(study, state, judged, e)}


def _may_be_a_disturbance(mechanism: Mechanism) -> bool:
    """Whether a law is an offset, or one where the motion has one direction."""
    return is_offset(mechanism) or ConstantBias.name in mechanism.generalises


def _needed_in_each_of_several(judged: Judgement, settings: DiagnosisSettings) -> bool:
    """Whether there are several validation experiments, and the effects remove most of the mismatch of free runs in each of them."""
    parts = [(judged.mismatch(True, {name}), judged.mismatch(False, {name})) for name in judged.judges]
    return len(parts) > 1 and all(after < settings.most_of_the_mismatch * before for after, before in parts)
