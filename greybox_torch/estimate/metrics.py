"""How well a simulation matches a measurement."""

from __future__ import annotations

import numpy as np


@np.errstate(over="ignore")
def fit_percent(measured: np.ndarray, simulated: np.ndarray) -> float:
    """100 (1 − ‖y − ŷ‖ / ‖y − ȳ‖) over the samples (N,) that are not missing; −inf where the simulation is not finite, or where all samples
    have one value.

    Source: L. Ljung, "System Identification Toolbox: User's Guide", normalised root mean square error fit.
    """
    known = ~np.isnan(measured)
    y, s = measured[known], simulated[known]
    if not np.isfinite(s).all():
        return float("-inf")
    if not len(y) or np.ptp(y) == 0.0:  # the mean of equal values is not always that value: it rounds
        return float("-inf")
    return float(100.0 * (1.0 - np.linalg.norm(y - s) / np.linalg.norm(y - y.mean())))


@np.errstate(over="ignore")
def root_mean_square(measured: np.ndarray, simulated: np.ndarray) -> float:
    """Root mean square error over the samples (N,) that are not missing, in the signal's unit; inf where not finite."""
    known = ~np.isnan(measured)
    error = measured[known] - simulated[known]
    return float(np.sqrt(np.mean(error**2))) if np.isfinite(error).all() else float("inf")


def final_prediction_error(mse: float, unknowns: int, samples: int) -> float:
    """Akaike's final prediction error, mse (1 + d/N) / (1 − d/N) with d unknowns and N samples: the mean squared error to be expected of
    other recordings of the kind. Infinite where there are no more samples than unknowns, which pass through all of them.

    Source: L. Ljung, "System Identification: Theory for the User", 2nd edition, 1999, sections 7.4 and 16.4.
    """
    share = unknowns / samples
    return mse * (1 + share) / (1 - share) if share < 1 else float("inf")


RUNS_AWAY = -1000.0
"""Fit in % below which a free run has run away: how far it came by the end of a recording says nothing."""


def digits_between(before: float, after: float, most: int = 4) -> int:
    """Decimals, one at the least, that show how two fits in % differ where both are near 100; ``most`` where even these do not."""
    return next((n for n in range(1, most) if f"{before:.{n}f}" != f"{after:.{n}f}"), most if before != after else 1)


def told_fit(value: float, decimals: int) -> str:
    """A fit in %, in words where the simulation ran away."""
    return f"below {RUNS_AWAY:.0f} %" if value < RUNS_AWAY else f"{value:.{decimals}f} %"
