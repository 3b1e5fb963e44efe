"""How large a free curve beside laws is by free runs of the validation experiments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def sized_by_free_runs(
    study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain], judged: Judgement
) -> Mapping[str, Gain]:
    """The gains, that of a free curve beside laws with its size by free runs where that is less than by windows.

    Over short windows what is slow is small, and what a law lacks beside it may look as large: a curve draws any of that. Seen: an encoder
    that is 2 mrad out over its turn, a curve of 62 % of what windows show of a pendulum's mismatch (0.97), and 1 % of what free runs show,
    where the drag of the air that the model lacked is nearly all.
    """
    curve = next((e.prefix for e in state.effects if e.mechanism.free), None)
    if curve is None or others is None or len(state.effects) < 2 or curve not in state.without or curve not in gains:
        return gains
    study.working_on(f"trying without {curve}")
    rest = state.without[curve]
    without = judged.having(finish(rest, study.settings, study.budget, study.recorded), others.places(rest))
    among = judged.judges - judged.unstable - without.unstable
    whole = judged.mismatch(False, among)
    if not (among and np.isfinite(whole) and whole > 0.0):
        return gains
    share = max(without.mismatch(True, among) - judged.mismatch(True, among), 0.0) / whole
    return {**gains, curve: replace(gains[curve], size=float(np.fmin(gains[curve].size, share)))}
