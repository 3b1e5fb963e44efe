"""Effects that there was no time to ask held-out windows about: free runs of the held-out experiments decide of them."""

from __future__ import annotations

from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def without_what_free_runs_do_not_need(
    study: Study, state: SearchState, others: HeldOut, judged: Judgement
) -> tuple[SearchState, Judgement]:
    """The state without the one of several effects without which free runs leave least, where that is no more than with it.

    Seen: a double pendulum whose search had used up its time: a ripple with six harmonics stood beside a joint's friction (0.85; validation
    81.6 % of its position, 91.5 % without it), which windows of the held-out experiments take back where there is time to ask them.
    """
    if len(state.effects) < 2 or not state.compared_without:
        return state, judged
    best, least = (state, judged), judged.mismatch(True)
    for prefix in (e.prefix for e in reversed(state.effects)):
        fewer = state.at(state.without[prefix])
        final = finish(fewer.current, study.settings, study.budget, study.recorded)
        by_it = judged.having(final, others.places(fewer.current))
        if by_it.holds and by_it.mismatch(True) <= least:
            best, least = (fewer, by_it), by_it.mismatch(True)
    return best
