"""The way from start values to an optimum of whole records: directly, by way of short windows, or from many starts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import count

import numpy as np

from greybox_torch.estimate.beginnings import cost_of, fits_of, tolerable, well_begun
from greybox_torch.estimate.free_run import FreeRun, simulate
from greybox_torch.estimate.global_search import look_around
from greybox_torch.estimate.levenberg_marquardt import Descending, Optimum, Settings, answered, descending
from greybox_torch.estimate.logarithmic import descending_on_logarithms
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.estimate.termination import Termination
from greybox_torch.estimate.window_fit import fit_windows
from greybox_torch.simulation.simulator import Simulator

POOR = 2.0
"""Start values are poor where their error is larger than this many times that of the optimum they lead to."""

TRUSTED = 75.0
"""Fit in % below which start values are poor in any case."""

CLOSE = 95.0
"""Fit in % from which another valley is not looked for."""

STARTS_A_PARAMETER, MOST_STARTS = 32, 256
"""How many start values are drawn where those given are poor."""

WINDOW_SHARES = (1 / 64, 1 / 16)
"""Window lengths, as shares of the longest record, that start values which do not simulate are led through."""

PATIENCE = 60
"""Iterations after which a descent that has not arrived is taken to creep."""

AFTER_SEARCH = 20
"""Iterations, at most, of a descent from start values that were looked for: the search has made most of them, and what is left creeps."""

CREEPING = 1e-6
"""Relative change of the cost from which an iteration on logarithms leads on; what follows ends the descent."""

FINER = 2
"""How often the steps of the simulation are refined after the parameters."""

Method = Callable[..., Descending[None]]

METHODS: tuple[Method, ...] = (descending, descending_on_logarithms, descending)
"""How whole records are descended on, one after the other."""

BETTER_BEGUN = METHODS[1:]
"""From start values that were looked for."""

Report = Callable[[int, float, float], None]
"""Called with an iteration of a descent, the cost there, and the step."""

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
    if starts is None:
        starts = 1 if found is not None and _trusted(fits, found) else _default_starts(problem, simulator)
    if starts > 1 and problem.free.any():
        elsewhere = look_around(
            problem, simulator, starts=starts, seed=options.seed, progress=options.progress, to_beat=options.to_beat
        )
        other = None
        if elsewhere is not None:
            limited = replace(options.settings, iterations=min(AFTER_SEARCH, options.settings.iterations))
            brief = replace(options, settings=limited)
            other = _whole_records(elsewhere.problem, brief, 0, BETTER_BEGUN, elsewhere.substeps)
        found = _better(found, other)
    return found


def improved(found: Descent | None, begin: Problem, options: DescentOptions) -> Descent | None:
    """The better of what was found and the optimum that a descent on whole records reaches from the values of ``begin``."""
    return _better(found, _whole_records(begin, options, 0))


def _trusted(before: np.ndarray, found: Descent) -> bool:
    """Whether the start values lay so near the optimum that it is the one meant, or it is so good that there is no better one."""
    there = found.run.at(found.optimum.point)
    after = fits_of(there, simulate(there, found.run.simulator))
    near = (before >= TRUSTED) & (100.0 - before <= POOR * (100.0 - after))
    return bool((near | (after > CLOSE)).all())


def _default_starts(problem: Problem, simulator: Simulator) -> int:
    """Without a compiler a pass takes seconds, and only the user can say that it is worth it."""
    return min(MOST_STARTS, STARTS_A_PARAMETER * int(problem.free.sum())) if simulator.compiled else 1


def _by_windows(problem: Problem, options: DescentOptions, simulator: Simulator) -> tuple[Problem, int]:
    """Better parameters by way of windows with free start states; each length is kept only if the one before simulates."""
    evaluations, longest = 0, int(problem.records.lengths.max())
    for share in WINDOW_SHARES:
        found = fit_windows(problem, simulator, max(20, round(share * longest)))
        if found is None:
            continue
        evaluations += found.evaluations
        problem = problem.with_values(found.problem.values)
        if options.progress is not None:
            options.progress(f"windows of {found.windows.steps} samples", evaluations, found.mean_square)
    return problem, evaluations


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
    """Descend by one method after the other, until the plain one has arrived; where it creeps, logarithms are for.

    Args:
        kept: what becomes of the descents before, where there are any.
    """
    samples, progress, number = run.problem.samples, options.progress, next(options.numbers)
    report, stage = None, "whole records" if number == 1 else f"whole records, descent {number} ({kept})"
    if progress is not None:
        report = lambda i, cost, _: progress(stage, i, 2 * cost / samples)  # noqa: E731
    found = answered(by_methods(run, options.settings, methods, report), run.quadratic, run.admissible)
    return None if found is None else Descent(run, found, before + found.evaluations)


def by_methods(
    run: FreeRun,
    settings: Settings,
    methods: Sequence[Method],
    report: Report | None = None,
) -> Descending[None]:
    """The questions of a descent by one method after the other, see :func:`_optimum`; its optimum counts the passes of all."""
    z, iterations, evaluations, optimum = run.start, 0, 0, None
    for method in methods:
        limited = replace(settings, iterations=min(PATIENCE, settings.iterations - iterations))
        if method is descending_on_logarithms:
            limited = replace(limited, tolerance=max(CREEPING, settings.tolerance))
        if limited.iterations <= 0:
            break
        here = yield from method(z, *run.bounds, settings=limited, on_iteration=_counted_on(report, iterations))
        if here is None:
            return None
        z, iterations, evaluations = here.point, iterations + here.iterations, evaluations + here.evaluations
        optimum = replace(here, iterations=iterations, evaluations=evaluations)
        if method is descending and here.termination is not Termination.iteration_limit:
            break
    return optimum


def _counted_on(report: Report | None, before: int) -> Report | None:
    """The next method's iterations, counted on from those ``before``: seen was a log that began anew every twenty."""
    return report if report is None else lambda i, cost, step: report(before + i, cost, step)


def _better(one: Descent | None, other: Descent | None) -> Descent | None:
    """The one of lower cost; the first of two that are as good."""
    if one is None or other is None:
        return other if one is None else one
    total = one.evaluations + other.evaluations
    best = other if other.optimum.model.cost < (1 - 1e-9) * one.optimum.model.cost else one
    return Descent(best.run, best.optimum, total)
