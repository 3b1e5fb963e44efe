"""The whole diagnosis: detect, locate, name, model, show the improvement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite
from typing import Any

from greybox_torch.data import DataSet
from greybox_torch.deadline import Deadline, until
from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.common_gain import with_common_gain
from greybox_torch.diagnosis.confirm.hardly_followed import hardly_followed
from greybox_torch.diagnosis.confirm.shown_by_free_runs import shown_by_free_runs
from greybox_torch.diagnosis.confirm.sizes import sizes
from greybox_torch.diagnosis.confirm.unstable import no_free_run_follows
from greybox_torch.diagnosis.contradictions import contradictions
from greybox_torch.diagnosis.describe import report_data
from greybox_torch.diagnosis.describe.effects import describe
from greybox_torch.diagnosis.describe.evidence import sentences
from greybox_torch.diagnosis.describe.left import in_one_output, mean_fits, what_is_left
from greybox_torch.diagnosis.describe.ranking import ranking
from greybox_torch.diagnosis.describe.residual_tests import detect
from greybox_torch.diagnosis.describe.rivals import Rival, rivals
from greybox_torch.diagnosis.describe.unsure import best_further, unsure_candidate
from greybox_torch.diagnosis.describe.without_a_name import A_DISTURBANCE, error_without_a_name, is_missing
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.findings import Findings, small_ones
from greybox_torch.diagnosis.further_searches import find_what_is_slow, find_with_more
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.not_tried import NotTried
from greybox_torch.diagnosis.progress import Journal, Progress
from greybox_torch.diagnosis.select.posterior import confidence, of_a_stopped_search
from greybox_torch.diagnosis.selection import find
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.stopping import or_else
from greybox_torch.diagnosis.stopwatch import Stopwatch
from greybox_torch.diagnosis.study import Study, silent
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.estimate.start_states import starts_of
from greybox_torch.linear_algebra import on_one_thread
from greybox_torch.mechanisms.stored import attachment_json
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import SimulationOptions


@dataclass(frozen=True)
class Diagnosis:
    """The verdict, and the model that it recommends.

    ``model`` with parameter ``values`` (the plain model where nothing is missing), start states ``initial`` by recording and state,
    and ``attachments``, the effects in the form that a checkpoint keeps. ``rivals``: each finding and what comes nearest to it.
    """

    verdict: Verdict
    model: GreyBoxModel
    values: dict[str, float]
    initial: dict[str, dict[str, float]]
    attachments: list[dict[str, Any]]
    rivals: tuple[Rival, ...] = ()


@on_one_thread
def diagnose(
    dataset: DataSet,
    model: GreyBoxModel,
    *,
    seed: int = 0,
    device: str = "cpu",
    time_limit: float | None = None,
    settings: DiagnosisSettings = DiagnosisSettings(),
    budget: SearchBudget = SearchBudget(),
    beliefs: Beliefs = NO_BELIEFS,
    progress: Callable[[str], None] = silent,
    on_progress: Callable[[Progress], None] = lambda progress: None,
) -> Diagnosis:
    """Find what physics ``model`` leaves out, from the estimation experiments; judge it on the validation experiments.

    Start states that the card does not mention are estimated, whatever the model's own default, so that a wrong start is not taken for
    missing physics. Choosing uses the estimation experiments alone; the validation experiments can only take a finding back. Where they
    show what the estimation experiments do not, one of them is taken to choose with, and no longer counts as validation.

    Ctrl-C stops the present stage; the verdict is then that of the best that is known, and says that it is not complete.

    Args:
        seed: kept in the verdict; the search itself draws no random numbers.
        time_limit: seconds after which the best verdict so far stands. The fit of the model as it stands, and the comparison of the result
            with all experiments, take the time that they need.
        settings: the thresholds that it decides by.
        budget: how much it may compute.
        beliefs: what is known beforehand.
        progress: told what is being done.
        on_progress: told where the diagnosis stands, the leading finding with it; from several threads.

    Raises:
        UserError: there is no estimation experiment.
        NumericalError: the model cannot be simulated from the start values even over short windows.
        KeyboardInterrupt: Ctrl-C before the model as it stands was fitted, or twice in what a verdict cannot be without.
    """
    clock, end = Stopwatch(), Deadline.after(time_limit)
    journal = Journal(on_progress)

    def report(text: str) -> None:
        journal.doing(text)
        progress(text)

    if not dataset.estimation():
        raise UserError(
            f"{dataset.place('[[experiment]] role:')} no experiment has the role 'estimation'; expected at least one"
        )
    make_study = partial(
        Study,
        options=SimulationOptions(device),
        settings=settings,
        budget=budget,
        beliefs=beliefs,
        report=report,
        journal=journal,
    )
    before_writing = Deadline(end.at - budget.seconds_for_writing)
    found = find_with_more(find(dataset, model, make_study, clock, end), model, make_study, clock, before_writing)
    found = find_what_is_slow(found, model, make_study, clock, before_writing, dataset)
    with until(before_writing):
        found, _ = or_else(partial(with_common_gain, found), lambda: found)
    told = partial(_diagnosis, found, dataset, model, seed, clock)
    return or_else(told, told)[0]


def _diagnosis(found: Findings, dataset: DataSet, model: GreyBoxModel, seed: int, clock: Stopwatch) -> Diagnosis:
    """The findings as a verdict, and the model that follows from them.

    Findings that would make the verdict contradict itself are taken back.

    Raises:
        NumericalError: the verdict contradicts itself without any finding.
    """
    told = _as_found(found, dataset, model, seed, clock)
    against = contradictions(told.verdict.as_json())
    if against and told.verdict.effects:
        told = _as_found(_taken_back(found, against), dataset, model, seed, clock, explained=True)
        against = contradictions(told.verdict.as_json())
    if against:
        raise NumericalError(
            f"the verdict on {model.title} would contradict itself: {'; '.join(against)}; try `greybox fit` and `greybox compare`, which "
            "show how well the model simulates the recordings"
        )
    return told


def _taken_back(found: Findings, against: Sequence[str]) -> Findings:
    """The findings without any effect, and why."""
    why = f"Everything found was taken back, as a verdict with it would contradict itself: {'; '.join(against)}."
    plain = found.state.at(found.state.plain)
    judged = found.judged.without_effects()
    return replace(found, state=plain, gains={}, judged=judged, by_parameters=None, more=(*found.more, why))


def _as_found(
    found: Findings, dataset: DataSet, model: GreyBoxModel, seed: int, clock: Stopwatch, *, explained: bool = False
) -> Diagnosis:
    """The findings as a verdict, whatever it says. ``explained``: whether effects explained the error that are no longer among them."""
    study, state, judged = found.study, found.state, found.judged
    effects, refinements = _told(found) if state.effects else ((), ())
    traces = report_data.traces(judged, bool(effects))
    detected = detect(judged.problem, traces, study.settings)
    clock.lap("validation and report data")
    left = None if effects else error_without_a_name(study, state, found.others, judged)
    chosen_by = times_noise(study.problem, state.plain, study.settings)
    tried, lost = found.complete and not explained, hardly_followed(judged)
    unexplained = left if is_missing(left, chosen_by, detected, tried, study.settings, lost) else None
    unstable = judged.unstable if effects else frozenset[str]()
    looked = not study.beliefs.exclude_all(model)
    answered = found.complete and (looked or unexplained is not None)
    disturbed = left if unexplained is None else None
    verdict = Verdict(
        dataset=dataset.name,
        model=model.title,
        seed=seed,
        seconds=clock.seconds,
        confidence=confidence(study, state, effects, answered, unexplained, judged.left(False)[1]),
        effects=effects,
        scores={name: comparison.scores for name, comparison in judged.comparisons(bool(effects)).items()},
        evidence=(
            *sentences(found.dataset, study, state, effects, found.gains, detected, not found.complete),
            *(judged.augmented.sentences() if effects else ()),
            *no_free_run_follows(unstable, study.settings, judged.lost),
            *((A_DISTURBANCE,) if disturbed is not None else ()),
            *found.more,
        ),
        stages=clock.stages,
        ranking=ranking(state),
        traces=traces,
        inputs=report_data.inputs(judged),
        no_longer_validation=report_data.no_longer_validation(dataset, found.dataset),
        too_short=report_data.too_short_to_choose(found.dataset, state.plain, study.settings),
        unsure=unsure_candidate(state, study.settings),
        short_validation=report_data.too_short_to_judge(dataset, judged, effects),
        parameters=report_data.parameters(judged, bool(effects)),
        complete=found.complete,
        unexplained=unexplained,
        disturbed=disturbed,
        refinements=refinements,
        left=None
        if effects and judged.by_windows_alone
        else what_is_left(
            judged,
            detected,
            bool(effects),
            study.settings.above_noise,
            shown=found.by_parameters is None,
            over_windows=times_noise(study.problem, state.current, study.settings),
            fits=mean_fits(judged, unstable),
            further=best_further(study, state),
            output=in_one_output(judged, bool(effects)),
        ),
        unstable=unstable,
        settings=study.settings,
        budget=study.budget,
        beliefs=study.beliefs,
        looked=looked,
        not_tried=NotTried.of(found.complete, found.cut, study.journal, bool(state.steps)),
    )
    final, chosen = (judged.augmented, state.current) if effects else (judged.plain, state.plain)
    attachments = [attachment_json(e, study.surroundings[e.port]) for e in chosen.effects]
    beside = rivals(state, study.settings, study.beliefs) if effects else ()
    return Diagnosis(verdict, chosen.model, final.values(), starts_of(final.problem), attachments, beside)


def _told(found: Findings) -> tuple[tuple[Effect, ...], tuple[Effect, ...]]:
    """The effects that are findings, and those that are too small for that; the latter by themselves are none of the model's."""
    if found.by_parameters is not None:
        return (found.by_parameters,), ()
    study, state, judged, end = found.study, found.state, found.judged, found.schedule.judging
    by_effect = sizes(study, state, found.gains)
    told = describe(study, state, judged.augmented, found.left, found.gains, by_effect, found.removed, end)
    if not found.complete:
        told = of_a_stopped_search(told, study.settings)
    small = small_ones(found, by_effect)
    if small.keys() == state.prefixes:
        shown = shown_by_free_runs(study, state, found.gains, judged)
        small = {p: why for p, why in small.items() if p not in shown or not isfinite(by_effect[p])}
    both = [(small.get(a.prefix), e) for a, e in zip(state.effects, told, strict=True)]
    return tuple(e for why, e in both if why is None), tuple(replace(e, why_small=why) for why, e in both if why)
