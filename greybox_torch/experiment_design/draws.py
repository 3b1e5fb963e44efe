"""Draws of parameters from what is known of them."""

from __future__ import annotations

import numpy as np


def drawn_with(covariance: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """One draw (n,) of normally distributed numbers about zero, with a ``covariance`` (n, n) that may be of very different units.

    Drawn in units of the standard deviations: an eigenvalue is as exact as the largest is, which beside a bulk modulus of 1e9 Pa leaves
    nothing of a valve's gain of 3e-7. Seen: that gain drawn as 1e-3, and evidence of 1e11 nats.
    """
    size = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale = np.where(size > 0, size, 1.0)
    correlation = covariance / np.outer(scale, scale)
    # What rounding makes of a correlation is no warning for anybody.
    return size * rng.multivariate_normal(np.zeros(len(size)), correlation, method="eigh", check_valid="ignore")
