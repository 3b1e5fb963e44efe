"""The published estimation with `scipy.optimize.least_squares` on the Numba simulation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from scipy.optimize import least_squares

from experiments.speed.peers import numba_arm, numba_sensitivities
from experiments.speed.records import SAMPLE_TIME, Published

STEP = 1.5e-8
"""Relative step of forward differences, the square root of the machine's precision."""


def estimate(
    task: Published, derivatives: Literal["differences", "sensitivities"], *, tolerance: float = 1e-8
) -> tuple[np.ndarray, float]:
    """The optimum (10,) and its mean squared error.

    MINPACK's method without bounds, which are not met on the way: SciPy's default, which spends half its time on singular values,
    measured three times slower to the same optimum.

    Args:
        derivatives: forward differences, the 11 runs of a Jacobian spread over the cores, or sensitivities on one core.
        tolerance: SciPy's `ftol`, `xtol` and `gtol`, by default SciPy's own.
    """
    jacobian = _differences(task) if derivatives == "differences" else _sensitivities(task)

    def residuals(scaled: np.ndarray) -> np.ndarray:
        return _simulated(task, (scaled * task.scale)[None])[0] - task.y

    found = least_squares(
        residuals,
        task.start / task.scale,
        jac=lambda scaled: jacobian(scaled * task.scale) * task.scale,
        method="lm",
        ftol=tolerance,
        xtol=tolerance,
        gtol=tolerance,
    )
    return found.x * task.scale, float(np.mean(found.fun**2))


def _simulated(task: Published, points: np.ndarray) -> np.ndarray:
    """Speeds (K, N) at K points of the unknowns."""
    rows = [task.at(z) for z in points]
    p, x0 = np.array([r[0] for r in rows]), np.array([r[1] for r in rows])
    return numba_arm.free_run(p, x0, np.broadcast_to(task.u, (len(points), len(task.u))).copy(), SAMPLE_TIME)


def _differences(task: Published) -> Callable[[np.ndarray], np.ndarray]:
    def jacobian(z: np.ndarray) -> np.ndarray:
        steps = STEP * np.maximum(np.abs(z), task.scale)
        y = _simulated(task, np.vstack([z, z + np.diag(steps)]))
        return ((y[1:] - y[0]) / steps[:, None]).T

    return jacobian


def _sensitivities(task: Published) -> Callable[[np.ndarray], np.ndarray]:
    count, size = len(task.free), len(task.start)
    seed, directions = np.zeros((numba_arm.PARAMETERS, size)), np.zeros((numba_arm.STATES, size))
    seed[task.free, np.arange(count)] = 1.0
    directions[task.free_states, np.arange(count, size)] = 1.0

    def jacobian(z: np.ndarray) -> np.ndarray:
        p, x0 = task.at(z)
        return numba_sensitivities.sensitivities(p, x0[None], task.u[None], SAMPLE_TIME, seed, directions)[1][0]

    return jacobian
