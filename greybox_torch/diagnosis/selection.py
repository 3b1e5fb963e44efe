"""What a search on the estimation experiments comes to, and what held-out windows leave of it.

A time limit or Ctrl-C cuts the present stage short and the next one goes on from the best that is known: first the search, then the
confirmation, each with a part of the time of its own. What a verdict cannot be without (the fit of the model as it stands) has no limit;
it is begun once more where Ctrl-C interrupted it, and a second Ctrl-C there ends the diagnosis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from greybox_torch.data import DataSet
from greybox_torch.deadline import Deadline, until
from greybox_torch.diagnosis.coarser import Coarser, coarser
from greybox_torch.diagnosis.confirm.free_runs import FreeRuns
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.take_back import confirm, held_out_gains
from greybox_torch.diagnosis.excerpts import excerpts
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.schedule import Schedule
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.friction_behind_springs import friction_behind_springs
from greybox_torch.diagnosis.select.offered import offer_all
from greybox_torch.diagnosis.select.other_values import other_values
from greybox_torch.diagnosis.select.plain_model import fit_plain_model, squared_errors, weighted_by_noise
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.select.weighed_anew import weighed_anew
from greybox_torch.diagnosis.select.wider_ranges import over_wider_ranges
from greybox_torch.diagnosis.stopping import best_so_far, or_else
from greybox_torch.diagnosis.stopwatch import Stopwatch
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.model import GreyBoxModel

MakeStudy = partial[Study]

SEARCH = "searching: screen, refit, select"
CONFIRMING = "confirming on held-out experiments"


@dataclass(frozen=True, kw_only=True)
class Selection:
    """What a search came to on the estimation experiments of a data set, and what windows of the others left of it.

    ``gains`` by effect, on held-out experiments; ``others`` None where there are none or time was too short to ask them. ``complete``:
    whether nothing was cut short; ``cut``: the stages that were. ``more``: which experiments were taken to choose with besides those of the
    card, in sentences. ``searched``: what the search came to before anything of it was taken back. ``schedule``: when what follows has to
    end; ``free_runs``: the experiments that it is judged on.
    """

    dataset: DataSet
    study: Study
    state: SearchState
    searched: Hypothesis
    others: HeldOut | None
    gains: Mapping[str, Gain]
    free_runs: FreeRuns
    schedule: Schedule
    complete: bool = True
    more: tuple[str, ...] = ()
    cut: tuple[str, ...] = ()


def find(
    dataset: DataSet,
    model: GreyBoxModel,
    make_study: MakeStudy,
    clock: Stopwatch,
    end: Deadline = Deadline(),
    found_before: Hypothesis | None = None,
    places: Places = NOWHERE,
    before: SearchState | None = None,
) -> Selection:
    """Search on the estimation experiments, and let windows of the others confirm what was found or take it back.

    Args:
        make_study: :class:`Study` with everything but the problem and how it is simulated.
        end: when the answer has to stand.
        found_before: what a search with fewer experiments came to.
        places: where positions begin beside it, in all experiments.
        before: what that search left, if its effects are to be kept where they leave less than a finding.
    """
    study = make_study(_problem(dataset, model))
    used = excerpts(dataset, study.budget.most_samples)
    if used.dataset is not dataset:
        study = replace(study, problem=_problem(used.dataset, model))
    simulator, problem_of = simulator_for(study.problem, study.options), partial(_problem, model=model)
    fewer = partial(
        coarser, used.dataset, study.problem, simulator, problem_of, settings=study.settings, budget=study.budget
    )
    some = fewer()
    study = _searching(replace(study, places=places, options=simulator.options), some)
    free_runs = FreeRuns(study, dataset)
    clock.lap("preparing")
    study, state = fit_plain_model(study)
    if study.recorded is None:
        some = fewer(left=partial(squared_errors, state.plain))
        if some.problem is not study.problem:
            study, state = fit_plain_model(_searching(study, some))
    schedule = Schedule.within(end, free_runs.seconds, study.budget)
    state = replace(state, found_before=found_before)
    study, state, complete = _searched(study, state, before, schedule.searching)
    weighed: tuple[str, ...] = ()
    if complete and (other := _from_other_values(study, state, schedule.searching)):
        study, state, complete = _searched(*other, before, schedule.searching)
    if complete:
        study, state = _friction_behind_springs(study, state, schedule.searching)
        study, state, weighed = _weighed_anew(study, state, schedule.searching)
        study, state = _over_wider_ranges(study, state, schedule.searching)
    clock.lap(SEARCH)
    searched = state.current
    others = HeldOut(some.dataset, study) if dataset.validation() else None
    state, gains, confirmed = _confirmed(study, state, others, schedule.confirming)
    clock.lap(CONFIRMING)
    ended = {SEARCH: complete, CONFIRMING: confirmed}
    return Selection(
        dataset=dataset,
        study=study,
        state=state,
        searched=searched,
        others=others,
        gains=gains,
        free_runs=free_runs,
        schedule=schedule,
        complete=all(ended.values()),
        more=(*used.sentences, *some.sentences, *weighed),
        cut=tuple(stage for stage, whole in ended.items() if not whole),
    )


def _searching(study: Study, some: Coarser) -> Study:
    """The study with the samples that are searched, and with all of them where those are fewer."""
    if some.problem is study.problem:
        return study
    return replace(study, problem=some.problem, recorded=study.problem.records, motion=None)


def _problem(dataset: DataSet, model: GreyBoxModel) -> Problem:
    return all_starts_free(dataset, make_problem(dataset, model, dataset.estimation()))


def _searched(
    study: Study, state: SearchState, before: SearchState | None, deadline: Deadline
) -> tuple[Study, SearchState, bool]:
    """The study with what is known of the ports, the best state, and whether the search ended by itself."""

    def told(better: SearchState) -> None:
        effects = [e.named for e in better.effects]
        study.journal.found(effects, size(better.plain.fits, better.plain.fits, better.current.fits, study.settings))

    begun, complete = (study, state), True
    offer_all(study, state)
    with until(deadline):
        begun, complete = or_else(partial(_weighted, study, state), lambda: begun)
        if complete:
            best, complete = best_so_far(search(*begun, before), begun[1], told)
            return begun[0], best, complete
    return *begun, complete


def _friction_behind_springs(study: Study, state: SearchState, deadline: Deadline) -> tuple[Study, SearchState]:
    """What was found with dry friction at a joined body that moves much less with it, where that goes farther; as it is where not."""
    with until(deadline):
        found, _ = or_else(partial(friction_behind_springs, study, state), lambda: None)
    return found or (study, state)


def _over_wider_ranges(study: Study, state: SearchState, deadline: Deadline) -> tuple[Study, SearchState]:
    """What was found over the ranges that its curve's signal has with it, where those are wider; as it is where they are not."""
    with until(deadline):
        found, _ = or_else(partial(over_wider_ranges, study, state), lambda: None)
    return found or (study, state)


def _weighed_anew(study: Study, state: SearchState, deadline: Deadline) -> tuple[Study, SearchState, tuple[str, ...]]:
    """What was found with what completes the model once outputs are weighed by what it leaves of each, and a sentence on that; as it is
    where nothing does.
    """
    with until(deadline):
        found, _ = or_else(partial(weighed_anew, study, state), lambda: None)
    return (study, state, ()) if found is None else (*found[:2], found[2:])


def _from_other_values(study: Study, state: SearchState, deadline: Deadline) -> tuple[Study, SearchState] | None:
    """Where a search begins anew, as the model as it stands leaves less with other values than with what was found; None where not."""
    with until(deadline):
        found, _ = or_else(partial(other_values, study, state), lambda: None)
    return None if found is None else (found[0], replace(found[1], found_before=state.found_before))


def _weighted(study: Study, state: SearchState) -> tuple[Study, SearchState]:
    """The study and the model as it stands with outputs weighted by their noise; as they are where nothing new is known of that."""
    weighted = weighted_by_noise(study, state)
    if len(study.problem.weights) == 1 and weighted.problem.most_noise is None:
        return study, state
    study, fitted = fit_plain_model(weighted)
    return study, replace(fitted, found_before=state.found_before)


def _confirmed(
    study: Study, state: SearchState, others: HeldOut | None, deadline: Deadline
) -> tuple[SearchState, dict[str, Gain], bool]:
    """What held-out experiments leave of a state, what its effects gain there, and whether they could all be asked."""
    complete = True
    with until(deadline):
        if not state.compared_without:  # the search was stopped
            state, complete = best_so_far(drop_superfluous(study, state), state)
        if others is None or not complete:
            return state, {}, complete
        state, complete = best_so_far(confirm(study, state, others), state)
        if not (complete and state.effects):
            return state, {}, complete
        gains, complete = or_else(lambda: held_out_gains(state, others), dict)
        return state, gains, complete
