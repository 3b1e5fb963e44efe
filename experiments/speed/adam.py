"""How many steps Adam needs to the optimum of the published estimation.

Adam's path does not depend on who computes the gradient. So the steps are counted with gradients of our engine, in minutes, and each is
charged with what a gradient takes the peer, for whom the same path would take days.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch

from experiments.speed.records import Published
from greybox_torch.estimate import Problem
from greybox_torch.simulation import Pass, Simulator, whole_records

LEARNING_RATES = (0.003, 0.01, 0.03)
"""In units of each unknown's start value. The best of them counts."""


Gradient = Callable[[np.ndarray], tuple[float, np.ndarray]]
"""From unknowns (10,) to the mean squared error and its gradient (10,)."""


@dataclass(frozen=True)
class Descent:
    """``steps`` taken; ``mse`` the smallest mean squared error met; whether that is the optimum within the tolerance."""

    learning_rate: float
    steps: int
    mse: float
    arrived: bool


def our_gradient(problem: Problem, task: Published) -> Gradient:
    """The gradient of our engine, one pass over the whole record."""
    simulator, windows = Simulator.of(problem.model, problem.free_names), whole_records(problem.records)
    directions = np.eye(len(task.x0))[None, list(task.free_states)]

    def gradient(z: np.ndarray) -> tuple[float, np.ndarray]:
        p, x0 = task.at(z)
        run = simulator.run(
            problem.records,
            Pass(windows, p, x0[None], tangents=True, start_directions=directions, weights=problem.weights),
        )
        assert run.normal is not None
        matrix = run.normal[0] / len(task.y)
        return float(matrix[-1, -1]), -2.0 * matrix[:-1, -1]

    return gradient


def descend(gradient: Gradient, task: Published, optimum: float, *, most: int, tolerance: float = 1e-4) -> Descent:
    """Adam with the learning rate that gets furthest in at most ``most`` steps: to ``optimum`` (1 + ``tolerance``), or near it."""
    found = [_descent(gradient, task, optimum * (1 + tolerance), rate, most) for rate in LEARNING_RATES]
    return min(found, key=lambda d: (not d.arrived, d.steps if d.arrived else d.mse))


def _descent(gradient: Gradient, task: Published, goal: float, rate: float, most: int) -> Descent:
    unknowns = torch.tensor(task.start / task.scale, requires_grad=True)
    adam, smallest = torch.optim.Adam([unknowns], lr=rate), np.inf
    for step in range(most):
        mse, slope = gradient(np.clip(unknowns.detach().numpy() * task.scale, task.lower, task.upper))
        if not (np.isfinite(mse) and np.isfinite(slope).all()):
            return Descent(rate, step, smallest, False)
        smallest = min(smallest, mse)
        if smallest <= goal:
            return Descent(rate, step, smallest, True)
        unknowns.grad = torch.as_tensor(slope * task.scale)
        adam.step()
    return Descent(rate, most, smallest, False)
