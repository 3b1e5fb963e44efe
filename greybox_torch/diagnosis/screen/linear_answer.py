"""What a linear model of the residual can explain: by the model's own parameters, and by further directions beside them.

A parameter that sits at one of its bounds can only move away from it. Projected out as one that is free, it takes away what it cannot
explain. Seen: an offset of a motor's torque, larger than half of its dead zone, which drew the zone on one side alone; the other half width
stood at zero, and with it free to fall below, the offset explained nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.bounded_step import bounded_step
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.linear_algebra import solve

HELD = 10.0
"""How much more than the residual's variance a step of a parameter as large as itself costs."""


@dataclass(frozen=True)
class LinearAnswer:
    """Normal equations of a residual, the last column of ``matrix``, whose first columns are the model's parameters.

    ``hold`` (n_p,): curvature that keeps the answer near the parameters it is valid for: steps beyond their own size cost. ``low`` and
    ``high`` (n_p,): how far they may move, zero beyond a bound that they are at, otherwise without end.
    """

    matrix: np.ndarray
    hold: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @staticmethod
    def of(matrix: np.ndarray, fitted: WindowFit) -> LinearAnswer:
        """Around fitted parameters, the first columns of ``matrix``."""
        problem = fitted.problem
        values, lower, upper = (a[problem.free] for a in (problem.values, problem.lower, problem.upper))
        hold = HELD * fitted.mean_square / np.where(values != 0.0, values, np.inf) ** 2
        low, high = np.where(values <= lower, 0.0, -np.inf), np.where(values >= upper, 0.0, np.inf)
        return LinearAnswer(matrix, hold, low, high)

    def beside_parameters(self, directions: np.ndarray) -> tuple[np.ndarray, float]:
        """The values (k,) of further columns (k,) that explain most beside the parameters, and the energy of the residual that is left."""
        columns = np.concatenate([np.arange(len(self.hold)), directions])
        size = self._solved(columns)
        inner = self.matrix[np.ix_(columns, columns)]
        left = float(self.matrix[-1, -1] - 2 * size @ self.matrix[columns, -1] + size @ inner @ size)
        return size[len(self.hold) :], left

    def _solved(self, columns: np.ndarray) -> np.ndarray:
        """Least-squares values of ``columns``, the parameters first."""
        n_p = len(self.hold)
        inner = self.matrix[np.ix_(columns, columns)].copy()
        inner[np.arange(n_p), np.arange(n_p)] += self.hold
        diagonal = np.diag(inner)
        scale = np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)
        scaled = inner * scale[:, None] * scale[None, :] + 1e-9 * np.eye(len(scale))
        right = self.matrix[columns, -1] * scale
        found = solve(scaled, right)
        if (found[:n_p] < self.low).any() or (found[:n_p] > self.high).any():
            open_ended = np.full(len(columns) - n_p, np.inf)
            low, high = np.concatenate([self.low, -open_ended]), np.concatenate([self.high, open_ended])
            found = bounded_step(scaled, right, low, high)
        return scale * found
