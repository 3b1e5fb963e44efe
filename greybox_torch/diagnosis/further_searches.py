"""Searches after the first: with a held-out experiment to choose with as well, and over longer windows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from greybox_torch.data import DataSet
from greybox_torch.deadline import Deadline, TimeIsUp, until
from greybox_torch.diagnosis.confirm.estimated_from_all import explained_without
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.longer_windows import longer_windows, sentence, stands
from greybox_torch.diagnosis.confirm.part_of_the_last import promote_part
from greybox_torch.diagnosis.confirm.promote_doubtful import promote_doubtful
from greybox_torch.diagnosis.confirm.promotion import (
    Promotion,
    promote_for_a_curve,
    promote_for_a_rival,
    promote_refusing,
    promote_unstable,
    promote_validation,
    replaces,
)
from greybox_torch.diagnosis.confirm.telling_apart import promote_to_tell_apart
from greybox_torch.diagnosis.findings import Findings, judge, without_refinements_alone
from greybox_torch.diagnosis.hypothesis.start_positions import places_in
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.selection import MakeStudy, Selection, find
from greybox_torch.diagnosis.stopwatch import Stopwatch
from greybox_torch.model import GreyBoxModel

AGAIN = "searching again with a held-out experiment to choose with"
LONGER = "searching again over longer windows"


def find_with_more(
    first: Selection,
    model: GreyBoxModel,
    make_study: MakeStudy,
    clock: Stopwatch,
    end: Deadline = Deadline(),
    given: DataSet | None = None,
) -> Findings:
    """``first``, or what is found with more experiments to choose with, where those show what the others do not; judged by free runs.

    Free runs judge what is selected in the end alone: what gives way to another selection needs no final fit. Where they take something of
    it back, it is selected once more with that known. Where time is limited each is judged at once, so that an answer stands.

    Args:
        end: when all of it has to be known.
        given: the data set before any experiment was taken to choose with as well; by default that of ``first``.
    """
    judged = partial(judge, clock=clock)
    search = partial(find, model=model, make_study=make_study, clock=clock, end=end)
    begun = _chosen_with(first.dataset)
    own_ones = _chosen_with(first.dataset if given is None else given)
    known = {begun: judged(first) if end.limited else first}
    while True:
        best, whole, in_time = _selected(known, begun, len(own_ones), search, judged if end.limited else None, end)
        own = best if isinstance(best, Findings) else judged(best)
        if not whole:
            return replace(own, complete=False, others=own.others if in_time else None, cut=(*own.cut, AGAIN))
        if own is best or (own.state is best.state and not own.judged.unstable):
            return own
        known[_chosen_with(own.dataset)] = own


def _selected(
    known: dict[tuple[str, ...], Selection],
    begun: tuple[str, ...],
    given: int,
    search: Callable[..., Selection],
    judged: Callable[[Selection], Findings] | None,
    end: Deadline,
) -> tuple[Selection, bool, bool]:
    """The selection that stands, from the one ``begun`` with and those with ever more experiments to choose with; whether the last search
    was whole, and whether nothing was stopped before the next one.

    Args:
        known: by the experiments that are chosen with; what is searched is added.
        given: how many of them there were before any was taken to choose with as well.
        search: finds a selection on a data set.
        judged: by free runs, what is found; None where that has time.
    """
    best = last = known[begun]
    try:
        with until(end):
            while last.complete and last.others is not None:
                promoted = len(_chosen_with(last.dataset)) - given
                more = _promotion(last, last.others) if promoted < last.study.settings.most_promoted else None
                if more is None:
                    break
                names = _chosen_with(more.dataset)
                if names not in known:
                    last.study.working_on(f"searching again, {more.taken} among the experiments to choose with")
                    before = last.state if more.same_effects and last.state.effects else None
                    places = _places(last, last.others)
                    found = search(more.dataset, found_before=last.searched, places=places, before=before)
                    found = replace(found, more=(*last.more, more.sentence()))
                    known[names] = found if judged is None else judged(found)
                last = known[names]
                if last.others and replaces(
                    last.others, best.state, last.state, more.same_effects or bool(_unstable(best))
                ):
                    best = last
                elif best.state.effects:
                    break  # one more experiment does not better what was found, and each costs a whole search
    except (TimeIsUp, KeyboardInterrupt):
        return best, False, False
    return best, last.complete or not best.complete, True


def _promotion(found: Selection, others: HeldOut) -> Promotion | None:
    """The data set with one more experiment to choose with: one that cannot score, whose free runs refuse what windows bear out, that shows
    what the others do not, or that speaks for another name."""
    asked = found.study, found.dataset, found.state, others
    return (
        promote_unstable(found.dataset, _unstable(found))
        or promote_refusing(found.dataset, found.state, others, found.searched, _refused_in(found))
        or promote_for_a_curve(found.dataset, found.state, others, found.searched)
        or promote_doubtful(*asked)
        or promote_validation(*asked)
        or promote_part(*asked)
        or promote_for_a_rival(*asked, found.gains)
        or promote_to_tell_apart(*asked, found.gains)
    )


def _places(last: Selection, others: HeldOut) -> Places:
    """Where positions that no sensor shows begin beside what was searched: in its own experiments, and in those held out as windows say.

    A search that placed all of them anew would at times bend a law until it fits the wrong places.
    """
    found = last.searched
    own = places_in(found.problem)
    return {**others.places(found), **own} if own and others.fits(found) else NOWHERE


def _unstable(found: Selection) -> frozenset[str]:
    """The experiments that no free run follows, where free runs were judged."""
    return found.judged.unstable if isinstance(found, Findings) else frozenset()


def _refused_in(found: Selection) -> str:
    """The experiment whose free runs took back what was found, where free runs were judged; "" for none."""
    return found.judged.refused_in if isinstance(found, Findings) else ""


def _chosen_with(dataset: DataSet) -> tuple[str, ...]:
    """The experiments that are chosen with."""
    return tuple(r.name for r in dataset.estimation())


def find_what_is_slow(
    first: Findings,
    model: GreyBoxModel,
    make_study: MakeStudy,
    clock: Stopwatch,
    end: Deadline = Deadline(),
    given: DataSet | None = None,
) -> Findings:
    """``first``, or what is found over longer windows, where free runs show what the others do not and that explains most of it.

    Args:
        end: when all of it has to be known.
        given: as in :func:`find_with_more`.
    """
    told = without_refinements_alone(first)
    asked = first.complete and first.others is not None
    budget = longer_windows(first.study, told.state, told.judged, first.searched) if asked else None
    if budget is None:
        return first
    try:
        with until(end):
            first.study.working_on("searching again over longer windows for what acts slowly")
            longer = partial(make_study, budget=budget, more_is_missing=True)
            last = find_with_more(find(first.dataset, model, longer, clock, end), model, longer, clock, end, given)
            found = stands(last.study, *((f.state, f.gains, f.judged) for f in (told, last)))
            needless = explained_without(last.study, last.judged) if found else ""
    except (TimeIsUp, KeyboardInterrupt):
        return replace(first, complete=False, others=None, cut=(*first.cut, LONGER))
    why = sentence(told.judged, told.state, first.searched, last.state)
    if found and not needless:
        return replace(last, more=(*first.more, *last.more, why))
    if not last.complete:
        return replace(first, complete=False, cut=(LONGER,))
    return replace(first, more=(*first.more, why, *([needless] if needless else [])))
