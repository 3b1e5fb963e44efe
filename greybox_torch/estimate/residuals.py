"""What prediction errors say about a model: whether they are white, and whether the input still explains part of them.

Source: L. Ljung, "System Identification: Theory for the User", 2nd ed., section 16.6. Missing samples (NaN) are left out of every sum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import correlate

LAGS = 25
NORMAL_99 = 2.58
"""99 % of a standard normal variable lies within plus and minus this."""


@dataclass(frozen=True)
class Correlation:
    """A normalised correlation function: ``values`` (L,) at ``lags`` (L,) in samples, and the 99 % ``bound`` of each value.

    If there is nothing to find, each value lies within ± bound with a probability of 99 %.
    """

    lags: np.ndarray
    values: np.ndarray
    bound: float

    @property
    def largest(self) -> float:
        """The largest absolute value over the lags that are tested: positive ones, and zero for the correlation with an input."""
        return float(np.abs(self._tested).max())

    @property
    def outside(self) -> int:
        """How many of the tested lags exceed the bound."""
        return int((np.abs(self._tested) > self.bound).sum())

    @property
    def tested(self) -> int:
        """How many lags are tested."""
        return len(self._tested)

    @property
    def _tested(self) -> np.ndarray:
        return self.values[self.lags >= 0]


def whiteness(errors: np.ndarray, lags: int = LAGS) -> Correlation:
    """Autocorrelation of prediction errors (N,) at the lags 1 … ``lags``, with the bound 2.58 / √N of white noise."""
    known = ~np.isnan(errors)
    filled = np.where(known, errors, 0.0)
    covariance = _covariance(filled, filled)
    middle, reach = len(errors) - 1, _reach(errors, lags)
    scale = covariance[middle]
    values = covariance[middle + 1 : middle + 1 + reach] / scale if scale > 0 else np.zeros(reach)
    return Correlation(np.arange(1, reach + 1), values, NORMAL_99 / float(np.sqrt(max(known.sum(), 1))))


def input_correlation(errors: np.ndarray, signal: np.ndarray, lags: int = LAGS) -> Correlation:
    """Correlation of prediction errors e (N,) with an input u (N,) some samples before, at the lags −``lags`` … ``lags``.

    At a positive lag k it is that of e(t) with u(t − k): a model with the right dynamics leaves none. At negative lags it is that with
    future inputs, which betrays feedback from the output to the input; these lags are for the eye and not tested. The bound allows for
    the colour of both signals, 2.58 √(P / N) with P = Σ_k R_e(k) R_u(k) over the lags up to N/4, tapered; the input's mean is removed.
    """
    level = signal[~np.isnan(signal)]
    filled = np.where(np.isnan(errors), 0.0, errors)
    centred = np.where(np.isnan(signal), 0.0, signal - (level.mean() if level.size else 0.0))
    count, middle, reach = len(errors), len(errors) - 1, _reach(errors, lags)
    of_errors, of_signal = _covariance(filled, filled), _covariance(centred, centred)
    size = float(np.sqrt(of_errors[middle] * of_signal[middle]))
    steps = np.arange(-reach, reach + 1)
    if not size > 0:
        return Correlation(steps, np.zeros(len(steps)), NORMAL_99 / float(np.sqrt(count)))
    values = _covariance(filled, centred)[middle - reach : middle + reach + 1] / size
    widest = max(reach, len(errors) // 4)
    near = slice(middle - min(widest, middle), middle + min(widest, middle) + 1)
    taper = 1.0 - np.abs(np.arange(near.start, near.stop) - middle) / (widest + 1)
    spread = float(np.sum(taper * of_errors[near] * of_signal[near])) / size**2
    return Correlation(steps, values, NORMAL_99 * float(np.sqrt(spread / count)))


def _covariance(later: np.ndarray, earlier: np.ndarray) -> np.ndarray:
    """Σ_t later(t) earlier(t − k) / N for all lags k from −(N − 1) to N − 1."""
    return correlate(later, earlier, mode="full", method="fft") / len(later)


def _reach(errors: np.ndarray, lags: int) -> int:
    return min(lags, len(errors) - 1)
