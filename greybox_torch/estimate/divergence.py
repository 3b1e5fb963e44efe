"""Where a simulation leaves what was measured and does not come back."""

from __future__ import annotations

import numpy as np

FAR = 100.0
"""Ranges of the measured signal beyond which a simulation has run away."""


def beyond_reach(measured: np.ndarray, simulated: np.ndarray) -> np.ndarray:
    """At which samples (N,) a simulation is no number, or farther from the measured signal's mean than it can be compared over."""
    known = measured[np.isfinite(measured)]
    if not known.size:
        return ~np.isfinite(simulated)
    reach = FAR * (float(np.ptp(known)) or 1.0)
    return ~(np.abs(simulated - known.mean()) < reach)


def diverges_from(measured: np.ndarray, simulated: np.ndarray) -> int | None:
    """The sample from which on a simulation (N,) is beyond reach to its end; None where it ends within it."""
    beyond = beyond_reach(measured, simulated)
    if not beyond.any() or not beyond[-1]:
        return None
    within = np.flatnonzero(~beyond)
    return int(within[-1]) + 1 if within.size else 0
