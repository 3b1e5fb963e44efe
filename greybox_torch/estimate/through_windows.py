"""The way to whole records by windows of growing length with free start states.

A free run from poor values may be caught in a valley though it simulates tolerably: what friction does adds up along the record, and a
descent makes the parameters follow that. Over windows nothing adds up, and what they leave tells how far the model can go. Seen: of eleven
complete robot arms whose values were some 10 % wrong, five were left at 3 to 267 times the error of the best.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.simulator import Simulator

WINDOW_SHARES = (1 / 64, 1 / 16)
"""Window lengths, as shares of the longest record."""

SHORTEST = 20
"""Samples of a window, at least."""

FAR_ABOVE = 2.0
"""Times the error over windows from which whole records may come nearer, from the values of windows or with other start states."""

Told = Callable[[str, int, float], None]
"""Called with a stage's name, how many passes it took, and the mean squared error there."""


def through_windows(problem: Problem, simulator: Simulator, told: Told | None = None) -> Iterator[WindowFit]:
    """Fits over windows, each begun with the values and start states of the one before; those that simulate."""
    longest = int(problem.records.lengths.max())
    shorter, passes = None, 0
    for share in WINDOW_SHARES:
        found = fit_windows(problem, simulator, max(SHORTEST, round(share * longest)), shorter=shorter)
        if found is None:
            continue
        shorter, problem, passes = found, problem.with_values(found.problem.values), passes + found.evaluations
        if told is not None:
            told(f"windows of {found.windows.steps} samples", passes, found.mean_square)
        yield found


def from_windows(fit: WindowFit) -> Problem:
    """The problem with the start states of the windows that begin an experiment, where those are free."""
    problem = fit.problem
    initial = problem.initial.copy()
    index = np.searchsorted(fit.windows.start, problem.records.first)
    free = problem.initial_free
    initial[:, free] = fit.starts[index][:, free]
    return replace(problem, initial=initial)
