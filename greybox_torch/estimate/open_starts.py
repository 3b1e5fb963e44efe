"""Which start states of windows are estimated: those that are not carried into it from the window before."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.windows import Windows


@dataclass(frozen=True)
class OpenStarts:
    """Indices ``states`` (n_s,) of the states of which start values are estimated, their tangents' first ``directions`` (W, n_s, n_x), and
    which of them are ``bound`` (W, n_s) in a window: what the model remembers begins anywhere where a record does, and nowhere else.
    """

    states: np.ndarray
    directions: np.ndarray
    bound: np.ndarray

    def without_bound(self, curvature: np.ndarray) -> np.ndarray:
        """The curvature (W, n_s, n_s) by which a bound start value, which moves nothing, stays where it is."""
        if not self.bound.any():
            return curvature
        size = max(float(np.einsum("wii->wi", curvature).max(initial=0.0)), np.finfo(float).tiny)
        return curvature + size * self.bound[:, :, None] * np.eye(len(self.states))


def open_starts(problem: Problem, windows: Windows) -> OpenStarts:
    """The open start states of windows of a problem's records."""
    remembered, count, n_x = _remembered(problem), len(windows.start), len(problem.carried)
    states = np.flatnonzero(~problem.carried | remembered)
    directions = np.broadcast_to(np.eye(n_x)[states], (count, len(states), n_x))
    if not remembered.any():  # of nearly all models, in every pass
        return OpenStarts(states, directions, np.zeros((count, len(states)), dtype=bool))
    later = ~np.isin(windows.start, problem.records.first)
    bound = later[:, None] & remembered[states]
    return OpenStarts(states, np.where(bound[:, :, None], 0.0, directions), bound)


def begun_with(problem: Problem, windows: Windows, starts: np.ndarray) -> Problem:
    """``problem`` with what its model remembers beginning where the first window of every experiment does, of ``starts`` (W, n_x)."""
    remembered = _remembered(problem)
    if not remembered.any():
        return problem
    first = np.searchsorted(windows.start, problem.records.first)
    return replace(problem, initial=np.where(remembered, starts[first], problem.initial))


def _remembered(problem: Problem) -> np.ndarray:
    """Which states (n_x,) hold what went on before a record."""
    names = problem.model.remembered_states()
    return np.array([s.name in names for s in problem.model.states], dtype=bool)
