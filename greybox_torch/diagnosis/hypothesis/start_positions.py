"""Where a position that no sensor shows begins, on experiments that had no part in the fit or beside those that had.

An effect that follows a position is at the right place only if the position begins at the right value. A free run over the record
drifts, and its phase with it; over short windows with free start states the position stays with the measured motion, so that one
number for an experiment, tried along the travel, tells where it begins.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.continued import continued
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import Simulator

FINER = (-0.6, -0.4, -0.2, 0.2, 0.4, 0.6)
"""Places around the best, in steps between neighbouring trials, that are looked at afterwards; in the end a fifth as wide."""


def placed(
    problem: Problem,
    simulator: Simulator,
    length: int,
    budget: SearchBudget,
    shorter: WindowFit | None = None,
    *,
    everywhere: bool = True,
    nearer: bool = True,
    kept: int | None = None,
) -> WindowFit | None:
    """A fit of the window start states alone, positions beginning where each experiment fits best; None where even windows overflow.

    Args:
        problem: with no free parameters, its start states estimated (:func:`estimate_initial`): a free run over the beginning and short
            windows along the whole record are at times led astray by different things.
        length: of the windows, in samples; from short ones, which are not led astray, to long ones, in which an effect that changes
            slowly along the travel shows.
        shorter: where the shorter windows placed it.
        everywhere: along the whole travel, not only near where ``problem`` has it.
        nearer: nearer to the best than one trial along the travel is to the next.
        kept: an experiment that begins where ``problem`` has it: the parameters are of a fit to it.
    """
    fit = fit_windows(problem, simulator, length, shorter=shorter, settings=budget.position_iterations)
    trials = problem.model.start_trials(problem.values)
    if fit is None or not trials:
        return fit
    places = [i for i, s in enumerate(problem.model.states) if s.name in trials[0]]
    names = [problem.model.states[i].name for i in places]
    grid = np.array([[t[n] for n in names] for t in trials])
    experiments = problem.records.experiments(fit.windows.start)
    step = np.ptp(grid, axis=0) / max(len(grid) - 1, 1)
    own = problem.initial[:, places]
    best, known = np.zeros_like(own) if everywhere else own, [own]
    closer = (np.outer(FINER, step), np.outer(FINER, step), np.outer(FINER, 0.2 * step))
    for moves in (*((grid,) if everywhere else ()), *(closer if nearer else ())):
        best = _best_of(
            fit, places, [*known, best, *(best + move for move in moves)], experiments, simulator, length, budget
        )
        if kept is not None:
            best[kept] = own[kept]
        known = []
        there = _moved(fit, places, best, experiments, simulator, length, budget)
        if there is not None:  # with the trajectories there, the next trial is nearer to the truth
            fit = continued(there, simulator, length, budget.position_iterations, budget)
    return fit


def places_in(problem: Problem) -> Places:
    """Where positions that no sensor shows begin in ``problem``; nowhere, where sensors show all of them."""
    trials = problem.model.start_trials(problem.values)
    if not trials:
        return NOWHERE
    index = {s.name: i for i, s in enumerate(problem.model.states)}
    begun = zip(problem.records.names, problem.initial, strict=True)
    return {experiment: {n: float(row[index[n]]) for n in trials[0]} for experiment, row in begun}


def _best_of(
    fit: WindowFit,
    places: list[int],
    trials: Sequence[np.ndarray],
    experiments: np.ndarray,
    simulator: Simulator,
    length: int,
    budget: SearchBudget,
) -> np.ndarray:
    """Of start positions (E, k) tried, those at which each experiment fits best."""
    best, least = trials[0].copy(), np.full(len(trials[0]), np.inf)
    moved = side_by_side(partial(_moved, fit, places, t, experiments, simulator, length, budget) for t in trials)
    for trial, found in zip(trials, moved, strict=True):
        if found is not None:
            energies = np.bincount(experiments, weights=found.energies, minlength=len(trial))
            better = energies < least
            best[better], least[better] = trial[better], energies[better]
    return best


def _moved(
    fit: WindowFit,
    places: list[int],
    to: np.ndarray,
    experiments: np.ndarray,
    simulator: Simulator,
    length: int,
    budget: SearchBudget,
) -> WindowFit | None:
    """``fit`` once more with the positions ``places`` of every experiment beginning at ``to`` (E, k)."""
    starts, initial = begun_at(fit.starts, places, to, experiments), fit.problem.initial.copy()
    initial[:, places] = to
    problem = replace(fit.problem, initial=initial)
    return fit_windows(problem, simulator, length, starts=starts, settings=budget.position_trial_iterations)


def begun_at(starts: np.ndarray, places: Sequence[int], to: np.ndarray, experiments: np.ndarray) -> np.ndarray:
    """Window starts (W, n_x) with the positions ``places`` of every experiment moved along, so that its first window begins at ``to``.

    Args:
        to: by experiment, shape (E, k).
        experiments: of every window, shape (W,).
    """
    moved, first = starts.copy(), np.searchsorted(experiments, np.arange(len(to)))
    moved[:, places] += (to - starts[first][:, places])[experiments]
    return moved
