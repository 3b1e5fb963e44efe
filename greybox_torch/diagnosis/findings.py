"""What a search on the estimation experiments finds, and what the other experiments make of it.

Ctrl-C cuts the present stage short and the next ones go on from the best that is known: first the search, then the confirmation, then
the final fits. What a verdict cannot be without (the fit of the model as it stands, the comparison with validation) is begun once more
where it was interrupted, and a second Ctrl-C there ends the diagnosis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.beyond_free_runs import said_of_windows
from greybox_torch.diagnosis.confirm.free_runs import Judgement
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.promotion import promote_validation, serves
from greybox_torch.diagnosis.confirm.take_back import confirm, held_out_gains, take_back_weakest
from greybox_torch.diagnosis.hypothesis.degenerate import degenerate
from greybox_torch.diagnosis.hypothesis.final import Final, finish, from_longest_windows
from greybox_torch.diagnosis.select.backward import drop, drop_superfluous
from greybox_torch.diagnosis.select.plain_model import fit_plain_model, weighted_by_noise
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import TimeIsUp, best_so_far, or_else, result_of
from greybox_torch.diagnosis.stopwatch import Stopwatch
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.model import GreyBoxModel

MakeStudy = partial[Study]


@dataclass(frozen=True)
class Findings:
    """What a search came to on the estimation experiments of a data set, and what the others made of it.

    ``gains`` by effect, on held-out experiments; ``complete``: whether nothing was cut short; ``more``: which experiments were taken to
    choose with besides those of the card, in sentences.
    """

    dataset: DataSet
    study: Study
    state: SearchState
    others: HeldOut | None
    gains: Mapping[str, Gain]
    judged: Judgement
    complete: bool
    more: tuple[str, ...] = ()


def find(dataset: DataSet, model: GreyBoxModel, make_study: MakeStudy, clock: Stopwatch) -> Findings:
    """Search on the estimation experiments, and let the others confirm what was found or take it back.

    Args:
        make_study: :class:`Study` with everything but the problem and how it is simulated.
    """
    problem = all_starts_free(dataset, make_problem(dataset, model, dataset.estimation()))
    study = make_study(problem)
    study = replace(study, options=simulator_for(problem, study.options).options)
    clock.lap("preparing")
    study, state, complete = _searched(study)
    clock.lap("searching: screen, refit, select")
    unlimited = study.without_limit()
    others = HeldOut(dataset, study) if dataset.validation() else None
    state, gains, confirmed = _confirmed(unlimited, state, others)
    clock.lap("confirming on held-out experiments")
    (plain, augmented), fitted = _finished(unlimited, state)
    clock.lap("final fits on whole records")
    judge = partial(_judged, unlimited, dataset, problem, others, plain)
    again = partial(judge, state, gains, augmented)
    (state, gains, judged, told), was_judged = or_else(again, again)
    clock.lap("validation and report data")
    return Findings(
        dataset, study, state, others, gains, judged, complete and confirmed and fitted and was_judged, told
    )


def find_with_more(first: Findings, model: GreyBoxModel, make_study: MakeStudy, clock: Stopwatch) -> Findings:
    """``first``, or what is found with more experiments to choose with, where those show what the others do not."""
    best = last = first
    try:
        while last.complete and last.others is not None:
            more = promote_validation(last.study, last.dataset, last.state, last.others)
            if more is None:
                return best
            last.study.working_on(f"searching again, {more.taken} among the experiments to choose with")
            last = replace(find(more.dataset, model, make_study, clock), more=(*last.more, more.sentence()))
            if last.state.effects and last.others and serves(last.others, best.state, last.state):
                best = last
    except (TimeIsUp, KeyboardInterrupt):
        return replace(best, complete=False)
    return replace(best, complete=best.complete and last.complete)


def _searched(study: Study) -> tuple[Study, SearchState, bool]:
    """The study with what is known of the ports, the best state, and whether the search ended by itself."""
    begun, complete = fit_plain_model(study), True
    if len(study.problem.weights) > 1:
        begun, complete = or_else(lambda: fit_plain_model(weighted_by_noise(*begun)), lambda: begun)
    study, state = begun
    if complete:
        state, complete = best_so_far(search(study, state), state)
    return study, state, complete


def _confirmed(study: Study, state: SearchState, others: HeldOut | None) -> tuple[SearchState, dict[str, Gain], bool]:
    """What held-out experiments leave of a state, what its effects gain there, and whether they could all be asked."""
    complete = True
    if not state.compared_without:  # the search was stopped
        state, complete = best_so_far(drop_superfluous(study, state), state)
    if others is None or not complete:
        return state, {}, complete
    state, complete = best_so_far(confirm(study, state, others), state)
    if not (complete and state.effects):
        return state, {}, complete
    gains, complete = or_else(lambda: held_out_gains(state, others), dict)
    return state, gains, complete


def _finished(study: Study, state: SearchState) -> tuple[tuple[Final, Final], bool]:
    """The model as it stands and the one with effects, fitted to whole records; as windows have them, where that was stopped."""

    def fits() -> tuple[Final, Final]:
        study.working_on("fitting whole records")
        plain = finish(state.plain, study.settings, study.budget)
        return plain, finish(state.current, study.settings, study.budget) if state.effects else plain

    def as_they_are() -> tuple[Final, Final]:
        plain = from_longest_windows(state.plain)
        return plain, from_longest_windows(state.current) if state.effects else plain

    return or_else(fits, as_they_are)


def _judged(
    study: Study,
    dataset: DataSet,
    problem: Problem,
    others: HeldOut | None,
    plain: Final,
    state: SearchState,
    gains: Mapping[str, Gain],
    augmented: Final,
) -> tuple[SearchState, Mapping[str, Gain], Judgement, tuple[str, ...]]:
    """Effects taken back, the weakest first, until those left hold on the validation experiments; and what a reader has to know of it."""
    study.working_on("judging on the validation experiments")
    judge = partial(Judgement, study, dataset, problem)
    judged, told = judge(state, plain, augmented), ()
    while state.effects and ((empty := _empty(study, state, augmented)) or not judged.holds):
        if not state.compared_without:
            state = result_of(drop_superfluous(study, state))
        if empty is not None and empty in state.prefixes:
            state = result_of(drop(study, state, empty))
        else:
            before, state = state, take_back_weakest(study, state, gains)
            told += said_of_windows(before, state, gains, judged, study.settings)
        # What one of several accounts for, others may take over.
        gains = held_out_gains(state, others) if others is not None and state.effects else {}
        augmented = finish(state.current, study.settings, study.budget) if state.effects else plain
        judged = judge(state, plain, augmented)
    return state, gains, judged, told


def _empty(study: Study, state: SearchState, augmented: Final) -> str | None:
    """An effect whose parameters, fitted to whole records, say nothing about the machine."""
    told = (augmented.values(), augmented.deviations())
    found = (e.prefix for e in state.effects if degenerate(e, study.surroundings, *told) is not None)
    return next(found, None)
