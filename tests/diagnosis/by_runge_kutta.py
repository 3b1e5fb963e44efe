"""Machines of tests, integrated without the package."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


def by_runge_kutta(
    rate: Callable[[np.ndarray, Any], np.ndarray], start: np.ndarray, inputs: np.ndarray, step: float, substeps: int
) -> np.ndarray:
    """The states (N, n_x) at the samples of the inputs (N,), each held over a step of so many Runge-Kutta steps."""
    x, h, states = start, step / substeps, []
    for u in inputs:
        states.append(x)
        for _ in range(substeps):
            k1 = rate(x, u)
            k2 = rate(x + h / 2 * k1, u)
            k3 = rate(x + h / 2 * k2, u)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + h * k3, u))
    return np.array(states)
