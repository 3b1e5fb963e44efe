"""The free parameters of a hybrid as one vector of numbers of order one, and what their size costs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.problem import Problem
from greybox_torch.training.hybrid import Hybrid

HALVINGS = 30


@dataclass(frozen=True)
class Unknowns:
    """Unknowns z = values / ``scale`` of the d free parameters of ``hybrid``.

    ``scale`` (d,): of a weight of the output the force that moves the outputs by as much as the physics errs; of a physical parameter
    the change that does so, or the parameter itself where that is less; one for hidden weights. ``rest`` (d,) is where the weak hold of
    the network's own unknowns pulls them, ``held`` (d,) which these are.
    """

    hybrid: Hybrid
    scale: np.ndarray
    rest: np.ndarray
    held: np.ndarray

    @staticmethod
    def of(hybrid: Hybrid, curvature: np.ndarray, mean_square: float) -> Unknowns:
        """From the mean square (d,) of the outputs' sensitivities and that of the error of the physics."""
        problem = hybrid.problem
        own, values = np.abs(problem.values[problem.free]), problem.values[problem.free]
        with np.errstate(divide="ignore"):
            moving = np.sqrt(mean_square / curvature)
        heights, network = hybrid.heights[problem.free], hybrid.is_network[problem.free]
        common = np.median(moving[heights][np.isfinite(moving[heights])]) if np.isfinite(moving[heights]).any() else 1.0
        bounded = np.where(own > 0, np.minimum(moving, own), np.where(np.isfinite(moving), moving, 1.0))
        widths = np.array([name.endswith(".v_0") for name in problem.free_names], dtype=bool)
        scale = np.where(heights, common, np.where(network & ~widths, 1.0, np.where(network, own, bounded)))
        return Unknowns(hybrid, scale, np.where(heights, 0.0, values / scale), network)

    @property
    def force(self) -> float:
        """The size of a weight of the output, in the unit of the port's force."""
        return float(self.scale[self.hybrid.heights[self.hybrid.problem.free]][0])

    @property
    def start(self) -> np.ndarray:
        """The unknowns (d,) at the hybrid's own values."""
        return self.of_values(self.hybrid.problem.values)

    def of_values(self, values: np.ndarray) -> np.ndarray:
        """The unknowns (d,) at parameter values (n_p,)."""
        return values[self.hybrid.problem.free] / self.scale

    def values(self, z: np.ndarray) -> np.ndarray:
        """Parameter values (n_p,) in their units."""
        values = self.hybrid.problem.values.copy()
        values[self.hybrid.problem.free] = z * self.scale
        return values

    def admitted(self, z: np.ndarray, before: np.ndarray) -> np.ndarray:
        """``z`` within the bounds, and so near to ``before`` that the joint constraints of the model hold."""
        problem = self.hybrid.problem
        low, high = problem.lower[problem.free] / self.scale, problem.upper[problem.free] / self.scale
        z = np.clip(z, low, high)
        for _ in range(HALVINGS):
            if problem.admissible(self.values(z)):
                return z
            z = 0.5 * (z + before)
        return before

    def cost(self, z: np.ndarray) -> tuple[float, np.ndarray]:
        """The sum of squares of the network's unknowns away from rest, and its gradient (d,)."""
        away = np.where(self.held, z - self.rest, 0.0)
        return float(away @ away), 2.0 * away

    def stiffness(self) -> np.ndarray:
        """Half the second derivative of the cost by the free parameters in their units (d,)."""
        return np.where(self.held, self.scale**-2.0, 0.0)

    def problem(self, z: np.ndarray) -> Problem:
        """The hybrid's problem at the unknowns ``z``."""
        return self.hybrid.problem.with_values(self.values(z))
