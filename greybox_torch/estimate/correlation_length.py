"""How many correlated errors say as much as one independent one."""

from __future__ import annotations

import numpy as np

LEAST_CORRELATION = 0.05
"""Autocorrelation below which errors count as independent."""


def correlation_length(errors: np.ndarray) -> float:
    """Samples that say as much as one independent sample, at least one: 1 + 2 Σ ρ(k) up to where ρ has fallen to next to nothing.

    Source: G. V. Bayley, J. M. Hammersley, Supplement to the J. of the Royal Statistical Society 8, 1946.

    Args:
        errors: (N,), in any unit.
    """
    centred = errors - errors.mean()
    spectrum = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    covariance = np.fft.irfft(spectrum)[: len(centred)]
    if covariance[0] <= 0:
        return 1.0
    correlation = covariance / covariance[0]
    faded = correlation < LEAST_CORRELATION
    end = int(np.argmax(faded)) if faded.any() else len(correlation)
    return 1.0 + 2.0 * float(correlation[1:end].sum())
