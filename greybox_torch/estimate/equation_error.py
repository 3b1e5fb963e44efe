"""What a model's equations leave of the measured motion: rates as the sensors show them less rates as the model has them.

Both sides are averaged with the same weights over stretches of a record, wide enough for the sensors' noise to be small. Nothing is
simulated, so that the error is the model's own at every instant, however far its free run would lead away. Rates are affine in the forces
at ports: what is left over there is a force that is missing.

Two forms, as noise has two ways in. In the direct form the error is that of the rates, which is right where the input is known and the
machine disturbed; in the inverse form it is that of the input, which is right where the motion is prescribed and the input measured, as on
a robot under control. The inverse form exists where every equation has an input.

Source: M. Gautier, "Dynamic identification of robots with power model", IEEE ICRA, 1997; W. Khalil, E. Dombre, Modeling, Identification
and Control of Robots, 2002, ch. 12; weights with compact support: M. Shinbrot, "On the analysis of linear and nonlinear systems",
Transactions of the ASME 79, 1957.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from greybox_torch.estimate.averaging import Stretches
from greybox_torch.estimate.levenberg_marquardt import Quadratic, Settings, minimise
from greybox_torch.estimate.motion_equations import MotionEquations
from greybox_torch.estimate.problem import Problem

ITERATIONS = Settings(iterations=20, tolerance=1e-4)
"""How far parameters are followed."""

HELD = 0.01
"""Stretches' worth of error that a parameter costs which moves by its own size from what is expected of it: only where data say nothing."""


@dataclass(frozen=True, eq=False)
class EquationError:
    """The errors of a model's equations, averaged over ``finest`` stretches and then over ``coarser`` ones, and how they are weighed.

    ``scales``: what the errors are measured in, one for every equation (in the inverse form, for every input).
    """

    equations: MotionEquations
    finest: Stretches
    coarser: Stretches | None
    inverse: bool
    scales: np.ndarray

    @staticmethod
    def of(equations: MotionEquations, finest: Stretches, coarser: Stretches | None, inverse: bool) -> EquationError:
        """With scales as large as the errors are at the values that the problem has."""
        count = len(equations.inputs) if inverse else len(equations.rows)
        return EquationError(equations, finest, coarser, inverse, np.ones(count)).rescaled()

    @property
    def problem(self) -> Problem:
        """The problem at the present parameters."""
        return self.equations.problem

    @property
    def count(self) -> int:
        """How many stretches there are."""
        return (self.coarser or self.finest).count

    def over(self, finest_means: np.ndarray) -> np.ndarray:
        """Means (…, R M) over the stretches of what was averaged over the finest ones (…, R, M_finest), in units of the scales."""
        means = finest_means if self.coarser is None else self.coarser.mean(finest_means)
        means = means / self.scales[:, None]
        return means.reshape(*means.shape[:-2], len(self.scales) * self.count)

    def mean(self, errors: np.ndarray) -> np.ndarray:
        """Means (…, R M) of errors (…, R, N), in units of the scales."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.over(self.finest.mean(errors))

    @cached_property
    def linearised(self) -> tuple[np.ndarray, np.ndarray]:
        """Errors (R M,) and their slopes (n_free, R M) over the free parameters, at the values that the problem has."""
        return self._linearised(self.equations.start)

    def _linearised(self, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        error, slopes = self.equations.linearised(free, inverse=self.inverse)
        return self.mean(error), self.mean(slopes)

    @cached_property
    def hold(self) -> np.ndarray:
        """Curvature (n_free,) that keeps parameters near what is expected of them where the motion says nothing."""
        expected = self.problem.expected[self.problem.free]
        return np.where(expected != 0.0, HELD / np.where(expected != 0.0, expected, 1.0) ** 2, 0.0)

    def fitted(self, settings: Settings = ITERATIONS) -> EquationError | None:
        """With the free parameters that leave least; None where the equations are not finite."""
        p = self.problem
        expected = p.expected[p.free]

        def quadratic(free: np.ndarray) -> Quadratic[None] | None:
            error, slopes = self._linearised(free)
            if not (np.isfinite(error).all() and np.isfinite(slopes).all()):
                return None
            away = free - expected
            cost = 0.5 * float(error @ error) + 0.5 * float(self.hold @ away**2)
            return Quadratic(cost, slopes @ error + self.hold * away, slopes @ slopes.T + np.diag(self.hold), None)

        bounds = p.lower[p.free], p.upper[p.free]
        found = minimise(
            quadratic,
            self.equations.start,
            *bounds,
            settings=settings,
            admissible=lambda free: p.admissible(whole(p, free)),
        )
        if found is None:
            return None
        return replace(self, equations=self.equations.at(whole(p, found.point)))

    def settled(self, turns: int = 3) -> EquationError | None:
        """Fitted, with every equation weighed by what the fit leaves of it, in turns."""
        found = self.fitted()
        for _ in range(turns - 1):
            found = None if found is None else found.rescaled().fitted()
        return found

    def rescaled(self) -> EquationError:
        """With scales as large as the errors are now."""
        left = np.sqrt(np.mean(self.linearised[0].reshape(len(self.scales), -1) ** 2, axis=1))
        return replace(self, scales=self.scales * np.maximum(np.nan_to_num(left), 1e-12))


def whole(problem: Problem, free: np.ndarray) -> np.ndarray:
    """All parameter values (n_p,) with the ``free`` ones replaced."""
    values = problem.values.copy()
    values[problem.free] = free
    return values
