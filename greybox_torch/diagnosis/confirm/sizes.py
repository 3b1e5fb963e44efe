"""How large effects are: which part of the mismatch is back without each."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.hypothesis.significance import over_the_same_windows
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.refit.curve import may_be_drawn
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def sizes(study: Study, state: SearchState, gains: Mapping[str, Gain]) -> dict[str, float]:
    """By effect, the share of the plain model's mismatch that leaving it out brings back.

    On held-out experiments; on the estimation experiments where those do not exercise the effect, or where there are none. Where the search
    was stopped before it knew what every effect brings, each has an equal part of what all of them account for together. A law that a free
    curve could draw as well, which joined it later, has at least what it brought before that.
    """
    together = size(state.plain.fits, state.plain.fits, state.current.fits, study.settings)
    found = {prefix: together / len(state.effects) for prefix in state.prefixes}
    for prefix in state.without:
        gain = gains.get(prefix)
        if gain is None or gain.unexercised(study.settings) or not np.isfinite(gain.size):
            found[prefix] = size(state.plain.fits, state.without[prefix].fits, state.current.fits, study.settings)
        else:
            found[prefix] = gain.size
    for law in state.effects:
        if law.prefix in state.without and (brought := _before_curve(study, state, law)) is not None:
            found[law.prefix] = float(np.fmax(found[law.prefix], brought))
    return found


def _before_curve(study: Study, state: SearchState, law: Attachment) -> float | None:
    """The size of a law without the free curve that joined it and could draw it as well; None where there is no such curve.

    Left out beside the curve, it would be the curve's. Seen: the offset of an amplifier, 95 % of a circuit's mismatch, a refinement of 1 %
    beside a curve (0.97) that is 4 %.
    """
    curve = next((e for e in state.effects if e is not law and may_be_drawn(law, e, study.surroundings)), None)
    done = None if curve is None else state.step_of(law.prefix)
    if done is None or done.taken is None:
        return None
    alone, before = done.taken.fitted, done.parent
    if before.effects != tuple(e for e in state.effects if e not in (law, curve)):
        return None
    plain = state.plain if before.effects else before  # a step of a search with fewer experiments has its own
    return size(plain.fits, before.fits, alone.fits, study.settings) if over_the_same_windows(plain, alone) else None
