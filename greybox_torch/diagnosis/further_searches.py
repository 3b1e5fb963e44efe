"""Searches after the first: with a held-out experiment to choose with as well, and over longer windows."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from greybox_torch.deadline import Deadline, TimeIsUp, until
from greybox_torch.diagnosis.confirm.longer_windows import longer_windows, sentence, stands
from greybox_torch.diagnosis.confirm.promotion import promote_validation, replaces
from greybox_torch.diagnosis.findings import Findings, MakeStudy, find
from greybox_torch.diagnosis.stopwatch import Stopwatch
from greybox_torch.model import GreyBoxModel

AGAIN = "searching again with a held-out experiment to choose with"
LONGER = "searching again over longer windows"


def find_with_more(
    first: Findings, model: GreyBoxModel, make_study: MakeStudy, clock: Stopwatch, end: Deadline = Deadline()
) -> Findings:
    """``first``, or what is found with more experiments to choose with, where those show what the others do not.

    Args:
        end: when all of it has to be known.
    """
    best = last = first
    try:
        with until(end):
            while last.complete and last.others is not None:
                more = promote_validation(last.study, last.dataset, last.state, last.others)
                if more is None:
                    return best
                last.study.working_on(f"searching again, {more.taken} among the experiments to choose with")
                found = find(more.dataset, model, make_study, clock, end, last.searched)
                last = replace(found, more=(*last.more, more.sentence()))
                if last.others and replaces(last.others, best.state, last.state):
                    best = last
                elif best.state.effects:
                    break  # one more experiment does not better what was found, and each costs a whole search
    except (TimeIsUp, KeyboardInterrupt):
        return replace(best, complete=False, others=None, cut=(*best.cut, AGAIN))
    if best.complete and not last.complete:
        return replace(best, complete=False, cut=(AGAIN,))
    return best


def find_what_is_slow(
    first: Findings, model: GreyBoxModel, make_study: MakeStudy, clock: Stopwatch, end: Deadline = Deadline()
) -> Findings:
    """``first``, or what is found over longer windows, where free runs show what the others do not and that explains most of it.

    Args:
        end: when all of it has to be known.
    """
    asked = first.complete and first.others is not None
    budget = longer_windows(first.study, first.state, first.judged) if asked else None
    if budget is None:
        return first
    try:
        with until(end):
            first.study.working_on("searching again over longer windows for what acts slowly")
            longer = partial(make_study, budget=budget)
            last = find_with_more(find(first.dataset, model, longer, clock, end), model, longer, clock, end)
            found = stands(last.study, *((f.state, f.gains, f.judged) for f in (first, last)))
    except (TimeIsUp, KeyboardInterrupt):
        return replace(first, complete=False, others=None, cut=(*first.cut, LONGER))
    told = sentence(first.judged, first.state, last.state)
    if found:
        return replace(last, more=(*first.more, *last.more, told))
    if not last.complete:
        return replace(first, complete=False, cut=(LONGER,))
    return replace(first, more=(*first.more, told))
