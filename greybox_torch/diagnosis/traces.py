"""What was recorded and what the models simulate, as a report draws them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Trace:
    """One output of one experiment: time (N,) s, measured (N,) with NaN = missing, and simulated by the three models (N,)."""

    experiment: str
    role: str
    output: str
    unit: str
    time: np.ndarray
    measured: np.ndarray
    start: np.ndarray
    refit: np.ndarray
    augmented: np.ndarray


@dataclass(frozen=True)
class InputTrace:
    """One input of one experiment as recorded: time (N,) s, values (N,) in ``unit``; ``held`` between samples, else on straight lines."""

    experiment: str
    input: str
    unit: str
    time: np.ndarray
    values: np.ndarray
    held: bool = False
