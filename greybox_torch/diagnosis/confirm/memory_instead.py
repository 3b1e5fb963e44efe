"""An unknown that remembers in the place of nothing, where what was found did not last and free runs leave much more than noise."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.confirm.far_better import Standing, leaving_far_less
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.select.memory import linear_residual
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def memory_instead(study: Study, searched: SearchState, others: HeldOut | None, judged: Judgement) -> Standing | None:
    """The model with a residual with memory alone, where that was not asked; None where free runs do not leave half of the mismatch or less
    with it, or windows do not bear it out beyond chance.

    A curve that follows one experiment to the noise leaves nothing for which a memory would be asked. Seen: moisture that furniture takes
    up, told as a curve of the moisture outside, 97 % of what one experiment leaves; no other bore it out, and at 11 times the noise nothing
    was said to be missing.

    Args:
        searched: what was found, none of which lasted.
    """
    settings = study.settings
    _, times, _ = judged.left(False)
    if others is None or searched.memory is not None or not searched.effects or not times > settings.far_above_noise:
        return None
    study.working_on("asking held-out experiments about what remembers in the place of names")
    plain = searched.at(searched.plain)
    alone = linear_residual(study, plain, plain)
    if not alone.took_one:
        return None
    alone = replace(alone, memory=alone, named=None, without={e.prefix: alone.plain for e in alone.effects})
    return leaving_far_less(study, alone, others, judged, lambda by_it: by_it.mismatch(False))
