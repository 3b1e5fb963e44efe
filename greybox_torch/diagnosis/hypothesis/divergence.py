"""How far the fitted outputs of two hypotheses lie apart, in the evidence that their difference could give."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.window_errors import window_errors
from greybox_torch.estimate.correlation_length import correlation_length


def divergence(one: Hypothesis, other: Hypothesis) -> float:
    """The logarithm of the likelihood ratio that their difference would give on these recordings, if ``one`` were right.

    Half the squared difference of their fitted outputs over the longest windows, in units of the mean square of the errors that ``one``
    leaves: noise, or what its law lacks, whichever is larger. Errors that are correlated over m samples count once in m.

    Source: S. Kullback, R. A. Leibler, Annals of Mathematical Statistics 22, 1951 (Gaussian errors of equal covariance).
    """
    return of_errors(*(window_errors(h.fits[-1], h.simulator) for h in (one, other)))


def of_errors(errors: np.ndarray, others: np.ndarray) -> float:
    """The same from what two hypotheses leave of the measurements, (n_y, N) each; what is NaN in one is not counted."""
    told = 0.0
    for own, its in zip(errors, others, strict=True):
        seen = ~(np.isnan(own) | np.isnan(its))
        if seen.any():
            level = max(float(np.mean(own[seen] ** 2)), 1e-300)
            told += 0.5 * float(np.sum((own[seen] - its[seen]) ** 2)) / level / correlation_length(own[seen])
    return told
