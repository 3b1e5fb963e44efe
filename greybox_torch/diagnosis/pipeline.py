"""The whole diagnosis: detect, locate, name, model, show the improvement."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.free_runs import Judgement
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.promotion import promote_validation, serves
from greybox_torch.diagnosis.confirm.take_back import confirmed, without_weakest
from greybox_torch.diagnosis.describe.effects import describe
from greybox_torch.diagnosis.describe.evidence import sentences
from greybox_torch.diagnosis.describe.profiles import window_errors
from greybox_torch.diagnosis.describe.residual_tests import detect
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.hypothesis.noise import FAR_ABOVE_NOISE, floor_known, times_noise
from greybox_torch.diagnosis.select.posterior import confidence, of_a_stopped_search
from greybox_torch.diagnosis.select.search import Search
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem
from greybox_torch.mechanisms.stored import attachment_json
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.stepper import make_stepper
from greybox_torch.simulation.substeps import choose_substeps


@dataclass(frozen=True)
class Diagnosis:
    """The verdict, and the model that it recommends.

    ``model`` with parameter ``values`` (the plain model where nothing is missing), start states ``initial`` by recording and state,
    and ``attachments``, the effects in the form that a checkpoint keeps.
    """

    verdict: Verdict
    model: GreyBoxModel
    values: dict[str, float]
    initial: dict[str, dict[str, float]]
    attachments: list[dict[str, Any]]


class _TimeIsUp(Exception):
    """The time limit has passed; the best hypothesis so far stands."""


@dataclass
class _Clock:
    """Time by stage, and the limit."""

    limit: float | None
    report: Callable[[str], None]
    began: float = field(default_factory=time.perf_counter)
    stages: dict[str, float] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        return time.perf_counter() - self.began

    def progress(self, text: str) -> None:
        self.report(text)
        if self.limit is not None and self.seconds > self.limit:
            raise _TimeIsUp

    def stage(self, name: str, since: float) -> float:
        now = self.seconds
        self.stages[name] = self.stages.get(name, 0.0) + now - since
        return now


def diagnose(
    dataset: DataSet,
    model: GreyBoxModel,
    *,
    seed: int = 0,
    device: str = "cpu",
    time_limit: float | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Diagnosis:
    """Find what physics ``model`` leaves out, from the estimation experiments; judge it on the validation experiments.

    Start states that the card does not mention are estimated, whatever the model's own default, so that a wrong start is not taken for
    missing physics. Choosing uses the estimation experiments alone; the validation experiments can only take a finding back. Where they
    show what the estimation experiments do not, one of them is taken to choose with, and no longer counts as validation.

    Args:
        seed: kept in the verdict; the search itself draws no random numbers.
        time_limit: seconds after which the search stops and the best verdict so far is given.

    Raises:
        UserError: there is no estimation experiment.
        NumericalError: the model cannot be simulated from the start values even over short windows.
    """
    clock = _Clock(time_limit, progress)
    if not dataset.estimation():
        raise UserError(
            f"{dataset.place('[[experiment]] role:')} no experiment has the role 'estimation'; expected at least one"
        )
    found = _found_with_more(_found(dataset, model, device, clock), model, device, clock)
    dataset, search, gains, judged = found.dataset, found.search, found.gains, found.judged
    plain, augmented, interrupted = judged.plain, judged.augmented, found.interrupted
    at = clock.seconds
    effects = describe(search, augmented, search.substeps, judged.sums, gains) if search.current.effects else ()
    if interrupted:
        effects = of_a_stopped_search(effects)
    traces = judged.traces(bool(effects))
    detected = detect(judged.problem, traces)
    clock.stage("validation and report data", at)
    unexplained = None if effects else _unexplained(search, found.others)
    verdict = Verdict(
        dataset=dataset.name,
        model=model.title,
        seed=seed,
        seconds=clock.seconds,
        confidence=confidence(search, effects, not interrupted, unexplained),
        effects=effects,
        scores={name: comparison.scores for name, comparison in judged.comparisons(bool(effects)).items()},
        evidence=(
            *sentences(dataset, search, effects, gains, detected, interrupted),
            *augmented.sentences(),
            *found.more,
        ),
        stages=clock.stages,
        ranking=_ranking(search),
        traces=traces,
        complete=not interrupted,
        unexplained=unexplained,
    )
    final = augmented if effects else plain
    chosen = search.current if effects else search.plain
    attachments = [attachment_json(e, search.surroundings[e.port]) for e in chosen.effects]
    return Diagnosis(verdict, chosen.model, final.values(), _starts(final.problem), attachments)


@dataclass(frozen=True)
class _Found:
    """What a search on the estimation experiments of a data set came to, and what the others made of it."""

    dataset: DataSet
    search: Search
    others: HeldOut | None
    gains: Mapping[str, Gain]
    judged: Judgement
    interrupted: bool
    more: tuple[str, ...] = ()
    """Which experiments were taken to choose with besides those of the card, in sentences."""


def _found(dataset: DataSet, model: GreyBoxModel, device: str, clock: _Clock) -> _Found:
    """Search on the estimation experiments, and let the others confirm what was found or take it back."""
    at = clock.seconds
    problem = all_starts_free(dataset, make_problem(dataset, model, dataset.estimation()))
    stepper = make_stepper(model, problem.free_names, device=device)
    substeps = choose_substeps(problem.driving_records, stepper, problem.values, problem.initial) or 1
    search = Search(problem, substeps, device, clock.progress)
    at = clock.stage("preparing", at)
    interrupted = _searched(search)
    at = clock.stage("searching: screen, refit, select", at)
    others = HeldOut(dataset, search.problem, substeps) if dataset.validation() else None
    gains = confirmed(search, others, clock.report)
    at = clock.stage("confirming on held-out experiments", at)
    clock.report("fitting whole records")
    plain = finish(search.plain, substeps, device=device)
    augmented = finish(search.current, substeps, device=device) if search.current.effects else plain
    at = clock.stage("final fits on whole records", at)
    clock.report("judging on the validation experiments")
    judged = Judgement(dataset, problem, search, plain, augmented, substeps, device, gains)
    while search.current.effects and not judged.holds:
        gains = without_weakest(search, gains)
        augmented = finish(search.current, substeps, device=device) if search.current.effects else plain
        judged = Judgement(dataset, problem, search, plain, augmented, substeps, device, gains)
    clock.stage("validation and report data", at)
    return _Found(dataset, search, others, gains, judged, interrupted)


def _found_with_more(first: _Found, model: GreyBoxModel, device: str, clock: _Clock) -> _Found:
    """``first``, or what is found with more experiments to choose with, where those show what the others do not."""
    best = last = first
    while not last.interrupted and last.others is not None:
        more = promote_validation(last.dataset, last.search, last.others)
        if more is None:
            break
        clock.report(f"searching again, {more.taken} among the experiments to choose with")
        found = _found(more.dataset, model, device, clock)
        last = replace(found, more=(*last.more, more.sentence()))
        if last.search.current.effects and last.others and serves(last.others, best.search, last.search):
            best = last
    return best


def _searched(search: Search) -> bool:
    """Run the search; whether the time limit or the user cut it short (the best hypothesis so far then stands)."""
    limited, search.progress = search.progress, lambda text: None
    search.begin()
    if len(search.problem.weights) > 1:
        search.problem = replace(search.problem, weights=_noise_weights(search))
        search.begin()
    search.progress = limited
    try:
        search.run()
    except (_TimeIsUp, KeyboardInterrupt):
        search.progress = lambda text: None
        search.prune()
        return True
    return False


def _unexplained(search: Search, others: HeldOut | None) -> float | None:
    """How many times the noise the model's error is on the worst experiment, if that is too much for badly determined friction."""
    errors = [times_noise(search.problem, search.plain)] if floor_known(search.problem) else []
    if others is not None and floor_known(others.problem):
        errors += list(others.times_noise(search.plain))
    return max((e for e in errors if FAR_ABOVE_NOISE < e < np.inf), default=None)


def _noise_weights(search: Search) -> np.ndarray:
    """Inverse size of the errors of every output over the shortest windows: a noisy sensor must not drown an exact one.

    This is the maximum-likelihood weighting where the outputs' noises are independent, their sizes estimated from a first fit.
    """
    errors = window_errors(search.plain.fits[0], search.plain.stepper, search.substeps)
    return 1.0 / np.sqrt(
        np.nanmean(errors**2, axis=1) + (1e-4 * np.nanstd(search.problem.records.y, axis=1)) ** 2 + 1e-300
    )


def _starts(problem: Problem) -> dict[str, dict[str, float]]:
    names = [s.name for s in problem.model.states]
    return {
        e: dict(zip(names, map(float, row), strict=True))
        for e, row in zip(problem.records.names, problem.initial, strict=True)
    }


def _ranking(search: Search) -> tuple[tuple[str, str, float, float | None], ...]:
    """Rows (port, mechanism, share explained in the first screen, gain after refit) of the first round, best first."""
    if not search.rounds:
        return ()
    first = search.rounds[0]
    best: dict[tuple[str, str], float] = {}
    for look in (look for at in first.looks for look in at):
        key = (look.attachment.port, look.attachment.mechanism.name)
        best[key] = max(best.get(key, 0.0), look.explained)
    gains = {(r.leader.attachment.port, r.leader.attachment.mechanism.name): r.gain for r in reversed(first.ranked)}
    rows = [(port, name, share, gains.get((port, name))) for (port, name), share in best.items()]
    return tuple(sorted(rows, key=lambda row: -row[2])[:20])
