"""How far the fitted outputs of two hypotheses lie apart, in the evidence that their difference could give."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.window_errors import window_errors

LEAST_CORRELATION = 0.05
"""Autocorrelation below which errors count as independent."""


def divergence(one: Hypothesis, other: Hypothesis) -> float:
    """The logarithm of the likelihood ratio that their difference would give on these recordings, if ``one`` were right.

    Half the squared difference of their fitted outputs over the longest windows, in units of the mean square of the errors that ``one``
    leaves: noise, or what its law lacks, whichever is larger. Errors that are correlated over m samples count once in m.

    Source: S. Kullback, R. A. Leibler, Annals of Mathematical Statistics 22, 1951 (Gaussian errors of equal covariance);
    G. V. Bayley, J. M. Hammersley, Supplement to the J. of the Royal Statistical Society 8, 1946 (independent samples).
    """
    told = 0.0
    errors, others = (window_errors(h.fits[-1], h.simulator) for h in (one, other))
    for own, its in zip(errors, others, strict=True):
        seen = ~(np.isnan(own) | np.isnan(its))
        if seen.any():
            level = max(float(np.mean(own[seen] ** 2)), 1e-300)
            told += 0.5 * float(np.sum((own[seen] - its[seen]) ** 2)) / level / correlation_length(own[seen])
    return told


def correlation_length(errors: np.ndarray) -> float:
    """Samples that say as much as one independent sample, at least one: 1 + 2 Σ ρ(k) up to where ρ has fallen to next to nothing.

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
