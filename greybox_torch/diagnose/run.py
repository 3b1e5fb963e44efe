"""The whole diagnosis: detect, locate, name, model, show the improvement."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.diagnose.detect import detect
from greybox_torch.diagnose.effects import describe
from greybox_torch.diagnose.evidence import sentences
from greybox_torch.diagnose.final import Final, finish
from greybox_torch.diagnose.held_out import Gain, gain, held_out_fits, timelines
from greybox_torch.diagnose.locate import window_errors
from greybox_torch.diagnose.probability import confidence
from greybox_torch.diagnose.restore import attachment_json
from greybox_torch.diagnose.select import Search
from greybox_torch.diagnose.verdict import Trace, Verdict
from greybox_torch.errors import UserError
from greybox_torch.estimate.comparison import Comparison, compare
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulate.side_by_side import side_by_side
from greybox_torch.simulate.stepper import Stepper, make_stepper
from greybox_torch.simulate.substeps import choose_substeps

LEAST_HELD_OUT = 1.0
"""Standard errors by which an effect must lower the error on held-out experiments to be kept."""


BEYOND_CHANCE = 3.0
"""Standard errors by which a free curve must beat named effects on held-out experiments, to be preferred to them."""

CONFIRMED = 5.0
"""Standard errors of held-out gain from which a finding stands whatever the free runs of the validation experiments say."""

UNEXERCISED = 2e-3
"""Share of the held-out error below which, either way, those experiments do not exercise an effect: they cannot take it back."""


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
    missing physics. Choosing uses the estimation experiments alone; the validation experiments can only take a finding back.

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
            f"{dataset.path}: [[experiment]] role: no experiment has the role 'estimation'; expected at least one"
        )
    problem = all_starts_free(dataset, make_problem(dataset, model, dataset.estimation()))
    stepper = make_stepper(model, problem.free_names, device=device)
    substeps = choose_substeps(problem.driving_tape, stepper, problem.values, problem.initial) or 1
    search = Search(problem, substeps, device, clock.progress)
    at = clock.stage("preparing", 0.0)
    interrupted = _searched(search)
    at = clock.stage("searching: screen, refit, select", at)
    gains = _confirmed(dataset, search, progress)
    at = clock.stage("confirming on held-out experiments", at)
    progress("fitting whole records")
    plain = finish(search.plain, substeps, device=device)
    augmented = finish(search.current, substeps, device=device) if search.current.effects else plain
    at = clock.stage("final fits on whole records", at)
    progress("judging on the validation experiments")
    judged = _Judgement(dataset, problem, search, plain, augmented, substeps, device, gains)
    while search.current.effects and not judged.holds:
        gains = _without_weakest(search, gains)
        augmented = finish(search.current, substeps, device=device) if search.current.effects else plain
        judged = _Judgement(dataset, problem, search, plain, augmented, substeps, device, gains)
    effects = describe(search, augmented, substeps, judged.sums, gains) if search.current.effects else ()
    traces = judged.traces(bool(effects))
    detected = detect(judged.problem, traces)
    clock.stage("validation and report data", at)
    verdict = Verdict(
        dataset=dataset.name,
        model=model.title,
        seed=seed,
        seconds=clock.seconds,
        confidence=confidence(search, effects, not interrupted),
        effects=effects,
        scores={name: comparison.scores for name, comparison in judged.comparisons(bool(effects)).items()},
        evidence=sentences(dataset, search, effects, gains, detected, interrupted),
        stages=clock.stages,
        ranking=_ranking(search),
        traces=traces,
        complete=not interrupted,
    )
    final = augmented if effects else plain
    chosen = search.current if effects else search.plain
    attachments = [attachment_json(e, search.surroundings[e.port]) for e in chosen.effects]
    return Diagnosis(verdict, chosen.model, final.values(), _starts(final.problem), attachments)


def _confirmed(dataset: DataSet, search: Search, progress: Callable[[str], None]) -> dict[str, Gain]:
    """Held-out gains by effect, after taking back, weakest first, every effect that gains nothing there."""
    if not dataset.validation() or not search.current.effects:
        return {}
    progress("confirming on held-out experiments")
    search.progress = progress
    problem = all_starts_free(dataset, make_problem(dataset, search.problem.model, dataset.validation()))
    if search.named is not None:
        named, curve = (held_out_fits(h, problem, search.substeps) for h in (search.named[0], search.current))
        if gain(named, curve).errors_away < BEYOND_CHANCE:
            search.settle_for_named()
    while search.current.effects:
        on_others = partial(held_out_fits, problem=problem, substeps=search.substeps)
        full, *without = side_by_side(partial(on_others, h) for h in (search.current, *search.without.values()))
        gains = {
            p: replace(gain(fits, full), timelines=timelines(fits, full))
            for p, fits in zip(search.without, without, strict=True)
        }
        weakest = min(gains, key=lambda p: gains[p].errors_away)
        found = gains[weakest]
        if found.errors_away > LEAST_HELD_OUT or abs(found.share) + found.error < UNEXERCISED:
            return gains
        search.drop(weakest)
    return {}


def _without_weakest(search: Search, gains: Mapping[str, Gain]) -> dict[str, Gain]:
    """Take back the effect that gained least on held-out experiments (the newest where that is not known); the gains of the others."""
    names = [e.prefix for e in search.current.effects]
    weakest = min(names, key=lambda n: gains[n].share) if all(n in gains for n in names) else names[-1]
    search.drop(weakest)
    left = {e.prefix for e in search.current.effects}
    return {n: g for n, g in gains.items() if n in left}


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


def _noise_weights(search: Search) -> np.ndarray:
    """Inverse size of the errors of every output over the shortest windows: a noisy sensor must not drown an exact one.

    This is the maximum-likelihood weighting where the outputs' noises are independent, their sizes estimated from a first fit.
    """
    errors = window_errors(search.plain.fits[0], search.plain.stepper, search.substeps)
    return 1.0 / np.sqrt(
        np.nanmean(errors**2, axis=1) + (1e-4 * np.nanstd(search.problem.tape.y, axis=1)) ** 2 + 1e-300
    )


def _starts(problem: Problem) -> dict[str, dict[str, float]]:
    names = [s.name for s in problem.model.states]
    return {
        e: dict(zip(names, map(float, row), strict=True))
        for e, row in zip(problem.tape.names, problem.initial, strict=True)
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


class _Judgement:
    """The models on every experiment: the card's values, the plain refit, and the model with effects."""

    def __init__(
        self,
        dataset: DataSet,
        problem: Problem,
        search: Search,
        plain: Final,
        augmented: Final,
        substeps: int,
        device: str,
        gains: Mapping[str, Gain],
    ) -> None:
        self.gains = gains
        self.recordings = dataset.recordings
        self.problem = all_starts_free(dataset, make_problem(dataset, problem.model, dataset.recordings))
        self.plain, self.augmented, self.substeps, self.device = plain, augmented, substeps, device
        self.start = self._compared(problem, problem.values, None)
        self.refit = self._compared(plain.problem, plain.problem.values, plain)
        has_effects = bool(search.current.effects)
        self.with_effects = (
            self._compared(augmented.problem, augmented.problem.values, augmented) if has_effects else self.refit
        )
        self.sums = tuple(self._energy(c) for c in (self.refit, self.with_effects))

    @property
    def holds(self) -> bool:
        """Whether the effects are borne out: over windows of the validation experiments, or by their free runs.

        A free run can go astray where the machine is nearly bistable, however right the model is; windows with free starts cannot.
        """
        confirmed = bool(self.gains) and all(g.errors_away > CONFIRMED for g in self.gains.values())
        return confirmed or self.sums[1] < (1 + UNEXERCISED) * self.sums[0]

    def comparisons(self, effects: bool) -> dict[str, Comparison]:
        return {"start": self.start, "refit": self.refit, "augmented": self.with_effects if effects else self.refit}

    def traces(self, effects: bool) -> tuple[Trace, ...]:
        last = self.with_effects if effects else self.refit
        result = []
        for e, recording in enumerate(self.recordings):
            for k, output in enumerate(self.problem.model.outputs):
                simulated = [c.simulated[e][:, k] for c in (self.start, self.refit, last)]
                measured, time_axis = self.problem.tape.y[k, self.problem.tape.span(e)], self.problem.tape.time(e)
                result.append(
                    Trace(recording.name, recording.role, output.name, output.unit, time_axis, measured, *simulated)
                )
        return tuple(result)

    def _compared(self, like: Problem, values: np.ndarray, final: Final | None) -> Comparison:
        """Free runs of all experiments; start states fitted on whole estimation records where there are any, else on the first tenth."""
        named = dict(zip(like.names, map(float, values), strict=True))
        problem = (
            self.problem.with_values(values)
            if like.model is self.problem.model
            else problem_for(self.problem, like.model, named)
        )
        stepper = make_stepper(like.model, (), device=self.device)
        started = estimate_initial(problem, stepper, substeps=self.substeps)
        if final is not None:
            initial = started.initial.copy()
            for row, name in zip(final.problem.initial, final.problem.tape.names, strict=True):
                initial[started.tape.names.index(name)] = row
            started = replace(started, initial=initial)
        return _scored(started, self.recordings, stepper, self.substeps)

    def _energy(self, comparison: Comparison) -> float:
        roles = [s.role for s in comparison.scores]
        judged = [s for s in comparison.scores if s.role == "validation" or "validation" not in roles]
        return float(sum(s.rmse**2 for s in judged))


def _scored(problem: Problem, recordings: tuple[Recording, ...], stepper: Stepper, substeps: int) -> Comparison:
    return compare(problem, recordings, stepper, substeps=substeps, estimate_starts=False)
