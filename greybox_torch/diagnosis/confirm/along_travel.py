"""Where positions that no sensor shows begin, as free runs of whole experiments have it.

Windows place them by what happens within each, and pass the place on from one to the next. Where the effect shows in few of them, such as
a stop that is hit twice, what slides in between is lost: the free run of the same model then hits the stop elsewhere, or never.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.hypothesis.start_positions import FINER
from greybox_torch.estimate.initial import beginning, free_run_energies
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.simulator import Simulator

DENSER = 4
"""Trials per trial of windows: a free run that meets a stop late comes out another way, and its error has many narrow minima."""


def begun_along_travel(problem: Problem, simulator: Simulator, experiments: Sequence[int]) -> Problem:
    """``problem`` with positions that no sensor shows beginning where free runs fit best, tried along the travel.

    Args:
        experiments: which are asked; where they begin now stays where nothing fits better.
    """
    trials = problem.model.start_trials(problem.values)
    if not trials:
        return problem
    columns = [i for i, s in enumerate(problem.model.states) if s.name in trials[0]]
    names = [problem.model.states[i].name for i in columns]
    told = np.array([[t[n] for n in names] for t in trials])
    grid = np.linspace(told.min(axis=0), told.max(axis=0), DENSER * (len(told) - 1) + 1)
    step = np.ptp(grid, axis=0) / max(len(grid) - 1, 1)
    moves = (np.outer(FINER, step), np.outer(0.2 * np.array(FINER), step))
    initial = problem.initial.copy()
    for e in experiments:
        part = beginning(problem, e, 1.0)
        initial[e] = best = _best_of(part, initial[e], columns, grid, simulator)
        for move in moves:
            initial[e] = best = _best_of(part, best, columns, best[columns] + move, simulator)
    return problem.with_values(problem.values, initial)


def _best_of(
    part: Problem, begun: np.ndarray, columns: Sequence[int], places: np.ndarray, simulator: Simulator
) -> np.ndarray:
    """Of ``begun`` (n_x,) and the same with the states ``columns`` at ``places`` (K, k) what the free run of ``part`` fits best from."""
    rows = np.repeat(begun[None], 1 + len(places), axis=0)
    rows[1:, columns] = places
    return rows[int(np.argmin(free_run_energies(part, rows, simulator)))]
