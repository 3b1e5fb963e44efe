"""The lowest point of a quadratic model within bounds."""

from __future__ import annotations

import numpy as np

from greybox_torch.linear_algebra import least_squares


def bounded_step(matrix: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The step s (n,) that minimises ½ sᵀ M s − rᵀ s within ``low`` ≤ s ≤ ``high``, for a positive definite ``matrix`` M (n, n).

    Cutting the free minimum off at the bounds would not do: where two parameters make up for one another and one of them has to stop, the
    other's step is wrong too, and the cost may rise in every direction that is tried.

    Source: active set, J. Nocedal and S. Wright, Numerical Optimization, 2006, ch. 16.
    """
    step, held = np.zeros(len(right)), np.zeros(len(right), dtype=bool)
    for _ in range(3 * len(right) + 1):
        step = _with_held(matrix, right, step, held)
        beyond = np.maximum(low - step, step - high) * ~held
        worst = int(np.argmax(beyond)) if len(beyond) else 0
        if len(beyond) and beyond[worst] > 0:
            held[worst] = True
            step[worst] = np.clip(step[worst], low[worst], high[worst])
            continue
        inward = _inward(matrix @ step - right, step, low, high, held)
        if not inward.any():
            break
        held[int(np.argmax(inward))] = False
    return np.clip(step, low, high)


def _with_held(matrix: np.ndarray, right: np.ndarray, step: np.ndarray, held: np.ndarray) -> np.ndarray:
    """The minimum over the unknowns that are not held."""
    result, free = step.copy(), ~held
    if free.any():
        wanted = right[free] - matrix[np.ix_(free, held)] @ step[held]
        result[free] = least_squares(matrix[np.ix_(free, free)], wanted, rcond=1e-14)
    return result


def _inward(gradient: np.ndarray, step: np.ndarray, low: np.ndarray, high: np.ndarray, held: np.ndarray) -> np.ndarray:
    """How strongly the model pulls each held unknown away from its bound; zero where it is pushed against it."""
    pull = np.where(step <= low, -gradient, gradient)
    least = 1e-12 * float(np.abs(gradient).max(initial=0.0))
    return np.where(held & (low < high) & (pull > least), pull, 0.0)
