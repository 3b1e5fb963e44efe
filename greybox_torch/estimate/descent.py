"""The way from start values to an optimum of whole records: directly, by way of short windows, or from many starts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import count

import numpy as np

from greybox_torch.estimate.beginnings import cost_of, fits_of, tolerable, well_begun
from greybox_torch.estimate.by_methods import BETTER_BEGUN, METHODS, Method, by_methods
from greybox_torch.estimate.free_run import FreeRun, simulate
from greybox_torch.estimate.global_search import look_around
from greybox_torch.estimate.levenberg_marquardt import Optimum, Settings, answered
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.estimate.through_windows import FAR_ABOVE, from_windows, through_windows
from greybox_torch.simulation.simulator import Simulator

POOR = 2.0
"""Start values are poor where their error is larger than this many times that of the optimum they lead to."""

TRUSTED = 75.0
"""Fit in % below which start values are poor in any case."""

CLOSE, ARRIVED = 95.0, 99.9
"""Fits in % from which another valley is not looked for, and from which windows are not asked whether there is one."""

STARTS_A_PARAMETER, MOST_STARTS = 32, 256
"""How many start values are drawn where those given are poor."""

AFTER_SEARCH = 20
"""Iterations, at most, of a descent from start values that were looked for: the search has made most of them, and what is left creeps."""

FINER = 2
"""How often the steps of the simulation are refined after the parameters."""

Progress = Callable[[str, int, float], None]
"""Called with a stage's name, an iteration and the mean squared error there."""


@dataclass(frozen=True)
class Descent:
    """An optimum of whole records, the run it belongs to, and how many passes it took before and in all."""

    run: FreeRun
    optimum: Optimum[None]
    evaluations: int


@dataclass(frozen=True)
class DescentOptions:
    """What every descent needs: how to simulate, when to stop, whom to tell, and the mean squared error that is known to be reached."""

    simulator: Simulator
    settings: Settings
    progress: Progress | None = None
    seed: int = 0
    to_beat: float = float("inf")
    numbers: Iterator[int] = field(default_factory=lambda: count(1), compare=False, repr=False)
    """Of the descents on whole records, for whom they are told to. It stands here since descents of one estimation are begun in many
    places; :func:`descend_nested` begins it anew.
    """

    def fine_enough(self, problem: Problem) -> Simulator:
        """The simulator with as many sub-steps as ``problem`` needs at its values."""
        return fine_enough(self.simulator, problem)

    def brief(self) -> DescentOptions:
        """For a descent from start values that were looked for."""
        return replace(self, settings=replace(self.settings, iterations=min(AFTER_SEARCH, self.settings.iterations)))


def descend(problem: Problem, options: DescentOptions, starts: int | None) -> Descent | None:
    """The best optimum found from the start values of ``problem``; None where not even short windows simulate.

    Args:
        starts: how many start values to descend from, those given among them; by default one, or many where those turn out poor.
    """
    simulator = options.fine_enough(problem)
    fits = fits_of(problem, simulate(problem, simulator))
    own, cost = well_begun(problem, simulator)
    if not tolerable(fits):
        of_own = fits_of(own, simulate(own, simulator))
        problem, fits = (own, of_own) if tolerable(of_own) else (problem, fits)
    begin, before = (problem, 0) if tolerable(fits) else _by_windows(problem, options, simulator)
    found = no_worse(_whole_records(begin, options, before), own, cost, options)
    return or_elsewhere(problem, fits, found, options, starts)


def no_worse(found: Descent | None, own: Problem, cost: float, options: DescentOptions) -> Descent | None:
    """What was ``found``, or what the start values lead to directly where that is worse than they are: ``own``, well begun, of ``cost``."""
    return found if found is not None and found.optimum.model.cost <= cost else improved(found, own, options)


def or_elsewhere(
    problem: Problem, fits: np.ndarray, found: Descent | None, options: DescentOptions, starts: int | None
) -> Descent | None:
    """What was ``found`` from start values that simulate with ``fits``, or what many others lead to, where that is better and asked for."""
    simulator = options.fine_enough(problem)
    if starts != 1:
        found = _nearer_by_windows(problem, found, options)
    if starts is None:
        starts = 1 if found is not None and _trusted(fits, found) else _default_starts(problem, simulator)
    if starts > 1 and problem.free.any():
        elsewhere = look_around(
            problem, simulator, starts=starts, seed=options.seed, progress=options.progress, to_beat=options.to_beat
        )
        other = None
        if elsewhere is not None:
            other = _whole_records(elsewhere.problem, options.brief(), 0, BETTER_BEGUN, elsewhere.substeps)
        found = _better(found, other)
    return found


def improved(found: Descent | None, begin: Problem, options: DescentOptions) -> Descent | None:
    """The better of what was found and the optimum that a descent on whole records reaches from the values of ``begin``."""
    return _better(found, _whole_records(begin, options, 0))


def _trusted(before: np.ndarray, found: Descent) -> bool:
    """Whether the start values lay so near the optimum that it is the one meant, or it is so good that there is no better one."""
    after = _fits(found)
    near = (before >= TRUSTED) & (100.0 - before <= POOR * (100.0 - after))
    return bool((near | (after > CLOSE)).all())


def _fits(found: Descent) -> np.ndarray:
    """Fit in % of every output of every experiment with what was found."""
    there = found.run.at(found.optimum.point)
    return fits_of(there, simulate(there, found.run.simulator))


def _default_starts(problem: Problem, simulator: Simulator) -> int:
    """Without a compiler a pass takes seconds, and only the user can say that it is worth it."""
    return min(MOST_STARTS, STARTS_A_PARAMETER * int(problem.free.sum())) if simulator.compiled else 1


def _by_windows(problem: Problem, options: DescentOptions, simulator: Simulator) -> tuple[Problem, int]:
    """Better parameters by way of windows with free start states, and how many passes they took."""
    evaluations = 0
    for fit in through_windows(problem, simulator, options.progress):
        problem, evaluations = problem.with_values(fit.problem.values), evaluations + fit.evaluations
    return problem, evaluations


def _nearer_by_windows(problem: Problem, found: Descent | None, options: DescentOptions) -> Descent | None:
    """What was ``found`` from the values of ``problem`` or, where windows leave far less, what those lead to if that is better."""
    if found is None or not problem.free.any() or (_fits(found) > ARRIVED).all():
        return found
    best, brief = found, options.brief()
    for fit in through_windows(problem, options.fine_enough(problem)):
        if 2 * best.optimum.model.cost <= FAR_ABOVE**2 * fit.mean_square * problem.samples:
            break
        best = _better(best, _whole_records(from_windows(fit), brief, 0)) or best
    return best


def _whole_records(
    problem: Problem,
    options: DescentOptions,
    before: int,
    methods: Sequence[Method] = METHODS,
    substeps: int = 1,
) -> Descent | None:
    """The optimum of whole records near the values of ``problem``, after so many passes, with at least so many sub-steps.

    Where the parameters have come to need finer steps than they began with, the optimum is found anew with those: from there, or, where
    that was an optimum of errors of the integration, from where it began.
    """
    simulator = options.fine_enough(problem)
    simulator = simulator.with_substeps(max(substeps, simulator.substeps))
    found = _optimum(FreeRun(problem, simulator), options, before, methods)
    for _ in range(FINER):
        if found is None:
            return None
        there = found.run.at(found.optimum.point)
        finer = options.fine_enough(there)
        if finer.substeps <= found.run.simulator.substeps:
            return found
        astray = cost_of(problem, finer) < cost_of(there, finer)
        problem, methods = (problem, methods) if astray else (there, methods[-1:])
        found = _optimum(
            FreeRun(problem, finer), options, found.evaluations, methods, "in the place of the last, in finer steps"
        )
    return found


def _optimum(
    run: FreeRun, options: DescentOptions, before: int, methods: Sequence[Method], kept: str = "the best is kept"
) -> Descent | None:
    """The optimum near the start of ``run``, and the passes before it counted as well.

    Args:
        kept: what becomes of the descents before, where there are any.
    """
    samples, progress, number = run.problem.samples, options.progress, next(options.numbers)
    report, stage = None, "whole records" if number == 1 else f"whole records, descent {number} ({kept})"
    if progress is not None:
        report = lambda i, cost, _: progress(stage, i, 2 * cost / samples)  # noqa: E731
    found = answered(by_methods(run, options.settings, methods, report), run.quadratic, run.admissible)
    return None if found is None else Descent(run, found, before + found.evaluations)


def _better(one: Descent | None, other: Descent | None) -> Descent | None:
    """The one of lower cost; the first of two that are as good."""
    if one is None or other is None:
        return other if one is None else one
    total = one.evaluations + other.evaluations
    best = other if other.optimum.model.cost < (1 - 1e-9) * one.optimum.model.cost else one
    return Descent(best.run, best.optimum, total)
