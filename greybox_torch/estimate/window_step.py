"""The Gauss-Newton model of a windowed fit, and the step that it proposes, window starts eliminated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.bounded_step import bounded_step
from greybox_torch.estimate.problem import Problem
from greybox_torch.linear_algebra import lengths, solve


@dataclass(frozen=True)
class Hold:
    """How weakly the unknowns are held where they began: weights of squared distances, of start states (n_x,) and parameters (n_p,)."""

    starts: np.ndarray
    weights: np.ndarray
    values: np.ndarray
    value_weights: np.ndarray

    def away(self, states: np.ndarray, open_states: np.ndarray, bound: np.ndarray) -> np.ndarray:
        """How far open start ``states`` (W, n_s) are from where they are held; not at all where they are ``bound`` (W, n_s)."""
        return np.where(bound, 0.0, states - self.starts[:, open_states])

    def cost(self, states: np.ndarray, open_states: np.ndarray, bound: np.ndarray, values: np.ndarray) -> float:
        """What it adds to the cost at open start ``states`` (W, n_s) and free ``values`` (n_p,)."""
        away, moved = self.away(states, open_states, bound), values - self.values
        return 0.5 * float((self.weights[open_states] * away**2).sum() + (self.value_weights * moved**2).sum())


@dataclass(frozen=True)
class WindowModel:
    """Cost, gradient and Gauss-Newton Hessian over windows: of the parameters (``gp``, ``hpp``), of each window's open start states
    (``gs``, ``hss``) and between the two (``hsp``); the mean squared error, the energy of every window (W,), and where the unknowns are;
    ``bound`` (W, n_s) marks start states that follow from the window before.
    """

    cost: float
    hpp: np.ndarray
    gp: np.ndarray
    hss: np.ndarray
    hsp: np.ndarray
    gs: np.ndarray
    mean_square: float
    energies: np.ndarray
    open_states: np.ndarray
    away: np.ndarray
    bound: np.ndarray
    moved: np.ndarray


def held(found: WindowModel, hold: Hold) -> WindowModel:
    """The pass with the weak holds added to cost, gradient and Hessian."""
    weights = hold.weights[found.open_states]
    away = hold.away(found.away, found.open_states, found.bound)
    return replace(
        found,
        cost=found.cost + hold.cost(found.away, found.open_states, found.bound, found.moved),
        hpp=found.hpp + np.diag(hold.value_weights),
        gp=found.gp + hold.value_weights * (found.moved - hold.values),
        hss=found.hss + np.diag(weights),
        gs=found.gs + weights * away,
    )


def stepped(
    problem: Problem, here: WindowModel, states: np.ndarray, damping: float, sizes: np.ndarray
) -> tuple[Problem, np.ndarray, float]:
    """The damped Gauss-Newton step within bounds, window starts eliminated, and how much it should lower the cost.

    Args:
        sizes: of the free parameters (n_free,), zero where none is known.
    """
    diagonal = np.einsum("wii->wi", here.hss)
    floor = 1e-12 * diagonal.max(
        axis=0, initial=0.0
    )  # of each state by itself: pressures in Pa stand beside positions in m
    damped = here.hss + np.eye(diagonal.shape[1]) * (damping * (diagonal + floor))[:, :, None]
    solved = solve(damped, np.concatenate([here.hsp, here.gs[..., None]], axis=2))
    back, own = solved[..., :-1], solved[..., -1]
    matrix = here.hpp - np.einsum("wsp,wsq->pq", here.hsp, back)
    right = -(here.gp - np.einsum("wsp,ws->p", here.hsp, own))
    now = problem.values[problem.free]
    scale = lengths(np.diag(here.hpp), sizes)
    scaled = matrix * scale[:, None] * scale[None, :] + damping * np.eye(len(scale))
    low, high = ((bound[problem.free] - now) / scale for bound in (problem.lower, problem.upper))
    taken = scale * bounded_step(scaled, right * scale, low, high)
    values = problem.values.copy()
    values[problem.free] = np.clip(now + taken, problem.lower[problem.free], problem.upper[problem.free])
    away = -(own + back @ taken)
    moved = states.copy()
    moved[:, here.open_states] += away
    return problem.with_values(values), moved, _predicted(here, taken, away)


def _predicted(here: WindowModel, taken: np.ndarray, away: np.ndarray) -> float:
    """How much the quadratic model falls by a step ``taken`` (n_p,) in the parameters and ``away`` (W, n_s) in the start states."""
    slope = float(here.gp @ taken + (here.gs * away).sum())
    bend = float(taken @ here.hpp @ taken + 2.0 * (away * (here.hsp @ taken)).sum())
    bend += float(np.einsum("ws,wst,wt->", away, here.hss, away))
    return -(slope + 0.5 * bend)
