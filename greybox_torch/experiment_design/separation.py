"""What a recording would say: evidence between hypotheses, the probabilities after it, and a parameter's standard deviation.

Sources: A. C. Atkinson, V. V. Fedorov, "The design of experiments for discriminating between two rival models", Biometrika 62, 1975
(T-optimality: what the rival cannot imitate by other parameters); K. Chaloner, I. Verdinelli, Statistical Science 10, 1995 (averages over
what is known of the parameters).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import ndtri

from greybox_torch.linear_algebra import pseudo_inverse

RELATIVE = 1e-10
"""Share of the largest eigenvalue, of a matrix scaled to unit diagonal, below which a direction counts as undetermined."""

QUANTILES = 400
"""Points of the normal distribution that an expectation is taken over."""


def scaled_inverse(matrix: np.ndarray) -> np.ndarray:
    """The pseudo-inverse of an information matrix (n, n) whose rows may be in very different units; zero for what is undetermined."""
    size = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    known = size > 0
    scale = np.where(known, 1.0 / np.where(known, size, 1.0), 0.0)
    return pseudo_inverse(matrix * np.outer(scale, scale), RELATIVE, hermitian=True) * np.outer(scale, scale)


def evidence(difference: np.ndarray, slopes: np.ndarray, known: np.ndarray) -> float:
    """The log-likelihood ratio that is expected between two hypotheses after the rival has been estimated anew, in nats.

    The least over the rival's unknowns δ of ½ ‖r − J δ‖² + ½ δᵀ I δ.

    Args:
        difference: of the outputs, in units of the errors, r (N,).
        slopes: the rival's outputs by its unknowns, J (N, n).
        known: what earlier recordings say of these, I (n, n).
    """
    pull = slopes.T @ difference
    imitated = pull @ scaled_inverse(slopes.T @ slopes + known) @ pull
    return 0.5 * max(0.0, float(difference @ difference - imitated))


def expected_probability(
    probabilities: Sequence[float], nats: np.ndarray, *, alike: np.ndarray | None = None, temperature: float = 1.0
) -> float:
    """The probability of the right hypothesis after a recording, averaged over which one is right and over the errors.

    A log-likelihood ratio whose mean is D has the variance 2 D where errors are Gaussian.

    Args:
        probabilities: of the hypotheses, before it.
        nats: (n, n), entry (a, b) the evidence for a against b where a is right.
        alike: (n, n), whether two hypotheses count as one.
        temperature: standard errors that count as one where the recording is judged.
    """
    share = np.asarray(probabilities, dtype=float) / np.sum(probabilities)
    same = np.eye(len(share), dtype=bool) if alike is None else alike | np.eye(len(share), dtype=bool)
    level = (np.arange(QUANTILES) + 0.5) / QUANTILES
    normal = ndtri(level)
    total = 0.0
    for a, own in enumerate(share):
        against, whole = np.zeros(QUANTILES), float(share[same[a]].sum())
        for b in np.flatnonzero(~same[a]):
            if own > 0:
                told = (nats[a, b] + np.sqrt(2.0 * nats[a, b]) * normal) / temperature**2
                against += share[b] / whole * np.exp(np.clip(-told, -700.0, 700.0))
        total += own * float(np.mean(1.0 / (1.0 + against)))
    return total


def seconds_for(
    probabilities: Sequence[float],
    nats: np.ndarray,
    seconds: float,
    wanted: float,
    *,
    alike: np.ndarray | None = None,
    temperature: float = 1.0,
) -> float:
    """How long a recording like one of so many ``seconds`` must be for a ``wanted`` expected probability; infinite where none suffices.

    The evidence grows in proportion to the time. Other arguments as for :func:`expected_probability`.
    """

    def expected(factor: float) -> float:
        return expected_probability(probabilities, factor * nats, alike=alike, temperature=temperature)

    if expected(1e6) < wanted:
        return np.inf
    low, high = 0.0, 1.0
    while expected(high) < wanted:
        low, high = high, 2.0 * high
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if expected(middle) >= wanted else (middle, high)
    return high * seconds


def deviation(slopes: np.ndarray, known: np.ndarray, index: int) -> float:
    """The standard deviation of an unknown after a recording; infinite where it stays undetermined.

    Args:
        slopes: outputs by unknowns, in units of the errors, J (N, n).
        known: what earlier recordings say, (n, n).
        index: which unknown.
    """
    variance = scaled_inverse(slopes.T @ slopes + known)[index, index]
    return float(np.sqrt(variance)) if variance > 0 else np.inf
