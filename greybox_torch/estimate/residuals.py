"""What prediction errors say about a model: whether they are white, and whether the input still explains part of them.

Source: L. Ljung, "System Identification: Theory for the User", 2nd ed., section 16.6. Missing samples (NaN) are left out of every sum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from greybox_torch.data import Channel, Recording
from greybox_torch.linear_algebra import least_squares

LAGS = 25
ORDER = 50
"""Past samples that predict what is not new in a signal."""

LEAST_NEW = 1e-6
"""Share of a signal's size from which what is new in it is more than rounding."""

NORMAL_99 = 2.58
"""99 % of a standard normal variable lies within plus and minus this."""


NEARLY_EVEN = 2.5
"""Ratio of long to short distances between a slower sensor's samples, at most: in rows of the recording they are of two neighbouring
lengths, or several times as long where a few are missing. Of samples lost at random most are short and some are many times as long."""

TAILS = (0.1, 0.9)
"""Shares of the distances that are shorter than the short and the long ones of them."""


@dataclass(frozen=True)
class Correlation:
    """A normalised correlation function: ``values`` (L,) at ``lags`` (L,) in samples, and the 99 % ``bound`` of each value.

    Samples are those of the errors' sensor, where that is slower than the recording (:func:`is_slower`).

    If there is nothing to find, each value lies within ± bound with a probability of 99 %.
    """

    lags: np.ndarray
    values: np.ndarray
    bound: float

    @property
    def defined(self) -> bool:
        """Whether both signals move: the correlation with one that does not is none, and given as zeros."""
        return bool(self.values.any())

    @property
    def largest(self) -> float:
        """The largest absolute value over the lags that are tested: positive ones, and zero for the correlation with an input."""
        return float(np.abs(self._tested).max())

    @property
    def outside(self) -> int:
        """How many of the tested lags exceed the bound."""
        return int((np.abs(self._tested) > self.bound).sum())

    @property
    def within_chance(self) -> bool:
        """Whether the largest is no more than chance gives in one of a hundred records where there is nothing to find, over all lags."""
        return self.largest <= self.bound * NormalDist().inv_cdf(1.0 - 0.005 / self.tested) / NORMAL_99

    @property
    def tested(self) -> int:
        """How many lags are tested."""
        return len(self._tested)

    @property
    def _tested(self) -> np.ndarray:
        return self.values[self.lags >= 0]


@dataclass(frozen=True)
class Residuals:
    """What is left of one output in one experiment: errors (N,), their whiteness, their correlation with each input."""

    recording: Recording
    output: Channel
    errors: np.ndarray
    whiteness: Correlation
    inputs: Mapping[str, Correlation]


def residuals_of(recording: Recording, output: Channel, simulated: np.ndarray, inputs: Sequence[str]) -> Residuals:
    """Measured less ``simulated`` (N,), and what that says with regard to the ``inputs`` named."""
    errors = recording.measured(output.name) - simulated
    correlations = {name: input_correlation(errors, recording.signals[name]) for name in inputs}
    return Residuals(recording, output, errors, whiteness(errors), correlations)


def whiteness(errors: np.ndarray, lags: int = LAGS) -> Correlation:
    """Autocorrelation of prediction errors (N,) at the lags 1 … ``lags``, with the bound 2.58 / √N of white noise.

    Those of a slower sensor (:func:`is_slower`) are taken as they follow each other.
    """
    (errors,) = _own_samples(errors)
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
    future inputs, for the eye and not tested: it betrays feedback where the input is white (else :func:`feedback_correlation`). The
    bound allows for the colour of both signals, 2.58 √(P / N) with P = Σ_k R_e(k) R_u(k) over the lags up to N/4, tapered; the input's
    mean is removed. Where the errors are of a slower sensor (:func:`is_slower`), lags are in its samples.
    """
    errors, signal = _own_samples(errors, signal)
    filled = np.where(np.isnan(errors), 0.0, errors)
    centred = np.where(np.isnan(signal), 0.0, signal - _mean(signal))
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


def is_slower(errors: np.ndarray) -> bool:
    """Whether errors (N,) are of a sensor that is slower than the recording: most of its samples are more than a row apart, and nearly
    evenly. Samples of which more than half were lost at random are not.

    Counted in samples of the recording there were lags without any pair, and others with a pair for one in two samples.
    """
    there = np.flatnonzero(~np.isnan(errors))
    if len(there) < 2:
        return False
    rows = np.diff(there)
    short, long = np.quantile(rows, TAILS)
    return bool(np.median(rows) > 1 and long <= NEARLY_EVEN * short)


def _own_samples(errors: np.ndarray, *signals: np.ndarray) -> tuple[np.ndarray, ...]:
    """Errors and signals (N,) where a slower sensor has samples; as they are of another."""
    there = ~np.isnan(errors) if is_slower(errors) else slice(None)
    return tuple(values[there] for values in (errors, *signals))


def feedback_correlation(errors: np.ndarray, signal: np.ndarray, lags: int = LAGS) -> Correlation:
    """Correlation of an input u (N,) with prediction errors e (N,) some samples before, both without what their own past predicts.

    At a positive lag k it is that of what is new in u(t) with what is new in e(t − k). An input that is not driven by the output has
    nothing new to do with errors before it, however wrong the model and however coloured the input; one that has nothing new in it (a
    sum of sines) gives zeros. At lag zero it is feedback within the sample time, where the input cannot act on the output as fast.
    An input that is recorded later than it acts, or with noise of its own, looks the same.

    Where the errors are of a slower sensor (:func:`is_slower`), lags are in its samples. What is new in the input is still what the samples
    of the recording do not predict: those of the sensor leave parts of the input between them, which errors follow without any feedback.

    Source: D. A. Pierce, L. D. Haugh, "Causality in temporal systems", Journal of Econometrics 5, 1977.
    """
    errors, new = _own_samples(errors, _new(signal))
    return input_correlation(new, _new(errors), lags)


def _new(signal: np.ndarray) -> np.ndarray:
    """What a linear prediction from the last :data:`ORDER` samples leaves of a signal (N,); NaN where one of those is missing."""
    result, order = np.full(len(signal), np.nan), min(ORDER, len(signal) // 10)
    rows = np.lib.stride_tricks.sliding_window_view(signal - _mean(signal), order + 1)
    known = ~np.isnan(rows).any(axis=1)
    past, present = rows[known, :-1], rows[known, -1]
    if len(present) > order:
        new = present - past @ least_squares(past, present)
        result[np.flatnonzero(known) + order] = new if new.std() > LEAST_NEW * present.std() else 0.0
    return result


def _mean(signal: np.ndarray) -> float:
    known = signal[~np.isnan(signal)]
    # within what is there, as the sum over a constant rounds: what is left of it would be correlated with
    return float(np.clip(known.mean(), known.min(), known.max())) if known.size else 0.0


def _covariance(later: np.ndarray, earlier: np.ndarray) -> np.ndarray:
    """Σ_t later(t) earlier(t − k) / N for all lags k from −(N − 1) to N − 1."""
    # scipy.signal.correlate, which does this, takes a second to import, scipy.fft with its fast lengths a sixth of one.
    size = 1 << (len(later) + len(earlier) - 2).bit_length()
    products = np.fft.irfft(np.fft.rfft(later, size) * np.fft.rfft(earlier[::-1], size), size)
    return products[: len(later) + len(earlier) - 1] / len(later)


def _reach(errors: np.ndarray, lags: int) -> int:
    return min(lags, len(errors) - 1)
