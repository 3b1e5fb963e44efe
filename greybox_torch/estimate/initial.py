"""Start states of an experiment, estimated on its first tenth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Settings, minimise
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import fit_windows
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows

BEGINNINGS = (
    "Free runs are begun with start states estimated on the first tenth of each experiment; in `greybox fit` and `greybox diagnose`, "
    "re-estimated models begin estimation experiments with the start states of their estimate, so that fits may differ. "
    "Start states that the card fixes are as it has them."
)
"""How free runs begin, for below a table of their fits."""

SHORT = 6
"""Into how many windows the beginning of a record is cut for a first guess of its start states."""

FRACTION = 0.1
"""Of an experiment, from its beginning, that its start states are estimated on."""

START_SETTINGS = Settings(iterations=30, tolerance=1e-8)

MOST_TRIALS = 2
"""How many of the possible start values are followed to their optimum."""


TELLS = 10.0
"""Difference of log-likelihoods by which the beginning of an experiment tells one start position from another: errors are hardly white."""


def estimate_initial(
    problem: Problem,
    simulator: Simulator,
    *,
    fraction: float = FRACTION,
    places: Mapping[str, Mapping[str, float]] | None = None,
) -> Problem:
    """The problem with the free start states of every experiment estimated on its first ``fraction``, parameters as they are.

    Start values that a model knows only up to a few possibilities (the angle at which a periodic effect begins) are tried one by one.
    Where the simulation fails from the start states given, or nothing is measured there, they are left as they are.

    Args:
        places: start positions by experiment and state, known otherwise; taken where that beginning does not speak against them.
    """
    trials = problem.model.start_trials(problem.values)
    names = [s.name for s in problem.model.states]
    tried = np.isin(names, list(trials[0])) if trials else np.zeros(len(names), dtype=bool)
    free = problem.initial_free | tried
    if not free.any():
        return problem

    def start_of(e: int) -> np.ndarray:
        part = beginning(replace(problem, initial_free=free), e, fraction)
        if not part.samples:
            return part.initial[0]
        best, cost = _best_start(part, trials, simulator)
        place = (places or {}).get(problem.records.names[e])
        there = None if place is None else _begun_at(replace(part, initial=best[None]), place, simulator)
        return best if there is None or there[1] >= np.exp(2.0 * TELLS / part.samples) * cost else there[0]

    rows = side_by_side(partial(start_of, e) for e in range(len(problem.records.first)))
    return problem.with_values(problem.values, np.array(rows))


def _begun_at(part: Problem, place: Mapping[str, float], simulator: Simulator) -> tuple[np.ndarray, float] | None:
    """The start states (n_x,) of the one experiment of ``part`` that fit it best with positions at ``place``, and the cost."""
    names = [s.name for s in part.model.states]
    initial, known = part.initial.copy(), np.isin(names, list(place))
    initial[0, known] = [place[n] for n in names if n in place]
    held = replace(part, initial=initial, initial_free=part.initial_free & ~known)
    best, cost = _best_start(held, (), simulator)
    return (best, cost) if np.isfinite(cost) else None


def _best_start(part: Problem, trials: Sequence[Mapping[str, float]], simulator: Simulator) -> tuple[np.ndarray, float]:
    """The start states (n_x,) of the one experiment of ``part`` that fit it best, and the cost."""
    names = [s.name for s in part.model.states]
    rows = np.repeat(part.initial, max(len(trials), 1), axis=0)
    for row, trial in zip(rows, trials, strict=False):
        row[[names.index(n) for n in trial]] = list(trial.values())
    if len(rows) > MOST_TRIALS:
        rows = _promising(part, rows, simulator)
    best, cost = part.initial[0], np.inf
    for initial in rows[:, None]:
        for begin in (initial, from_short_windows(replace(part, initial=initial), simulator)):
            run = FreeRun(replace(part, initial=begin), simulator)
            optimum = minimise(run.quadratic, run.start, *run.bounds, settings=START_SETTINGS)
            if optimum is not None and optimum.model.cost < (1 - 1e-6) * cost:
                best, cost = run.at(optimum.point).initial[0], optimum.model.cost
    return best, cost


def _promising(part: Problem, rows: np.ndarray, simulator: Simulator) -> np.ndarray:
    """Those of the start states ``rows`` (K, n_x) that simulate best, the states that are not tried from short windows."""
    others = part.initial_free & (np.ptp(rows, axis=0) == 0)
    rows = np.where(others, from_short_windows(part, simulator), rows)
    return rows[np.argsort(free_run_energies(part, rows, simulator), kind="stable")[:MOST_TRIALS]]


def free_run_energies(part: Problem, rows: np.ndarray, simulator: Simulator) -> np.ndarray:
    """Sums of squared weighted errors (K,) of free runs of the one experiment of ``part`` from start states (K, n_x); infinite where one
    overflows.
    """
    first, last = (np.repeat(end, len(rows)) for end in (part.records.first, part.records.last))
    windows = Windows(first, last, int(part.records.lengths[0]))
    run = simulator.run(part.driving_records, Pass(windows, part.values, rows, weights=part.weights))
    assert run.normal is not None
    return np.nan_to_num(run.normal[:, -1, -1], nan=np.inf)


def from_short_windows(part: Problem, simulator: Simulator) -> np.ndarray:
    """Start states (1, n_x) from a short stretch at the beginning, where a wrong guess has no time to lead astray."""
    length = max(20, int(part.records.lengths[0]) // SHORT)
    fit = fit_windows(part, simulator, length, settings=Settings(iterations=15, tolerance=1e-4))
    if fit is None:
        return part.initial
    return np.where(part.initial_free, fit.starts[:1], part.initial)


def samples_of_beginning(samples: int, fraction: float = FRACTION) -> int:
    """How many of so many samples start states are estimated on."""
    return max(10, int(np.ceil(fraction * samples)))


def beginning(problem: Problem, experiment: int, fraction: float) -> Problem:
    """The first ``fraction`` of one experiment as a problem of its own, of which only the start states are estimated."""
    span = problem.records.span(experiment)
    length = samples_of_beginning(span.stop - span.start, fraction)
    part = slice(span.start, min(span.start + length, span.stop))
    return replace(
        problem,
        records=problem.records.part([part], [problem.records.names[experiment]]),
        initial=problem.initial[experiment : experiment + 1],
        free=np.zeros_like(problem.free),
    )
