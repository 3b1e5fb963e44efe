"""Measured signals smoothed without delay, each up to the frequency at which it disappears in its noise.

Signal and noise are differentiated alike, so that the frequency up to which a signal stands above its noise is the same for all of its
derivatives: beyond it a derivative is noise. What is below is kept by local cubic polynomials, which have no phase.

Source: M. Gautier, "Dynamic identification of robots with power model", IEEE ICRA, 1997, for derivatives by zero-phase filters with a
cut-off from the machine's bandwidth; A. Savitzky, M. J. E. Golay, Analytical Chemistry 36(8), 1964; R. W. Schafer, "What is a
Savitzky-Golay filter?", IEEE Signal Processing Magazine 28(4), 2011, for their cut-off frequency.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import polynomial

from greybox_torch.linear_algebra import pseudo_inverse

ABOVE_NOISE = 4.0
"""Times the noise's spectral density from which a signal is seen."""

LONGEST_SEGMENT = 2048
"""Samples of the stretches that a spectrum is the mean of."""

FEWEST = 32
"""Samples that a spectrum needs."""

ORDER = 3
"""Of the local polynomials."""

MARGIN = 2.5
"""How far beyond the frequencies that are to be kept local polynomials begin to take away: these are then as they were."""

WIDEST = 0.05
"""Most of a record that a local polynomial covers on one side."""


def band(y: np.ndarray) -> float:
    """Up to which frequency, in cycles per sample (0.5 at most), a signal y (n,) without gaps stands above its noise; 0 where nowhere.

    The noise is what the spectrum does not fall below in its upper half.
    """
    if len(y) < FEWEST or not np.ptp(y) > 0:
        return 0.0
    frequency, density = _spectrum(y, min(LONGEST_SEGMENT, max(FEWEST, len(y) // 8)))
    noise = float(np.quantile(density[frequency > 0.25], 0.2))
    seen = np.flatnonzero(density[1:] > ABOVE_NOISE * noise)
    return float(frequency[seen[-1] + 1]) if len(seen) else 0.0


def smoothed(y: np.ndarray, cutoff: float, *, slope: bool = False) -> np.ndarray:
    """A signal y (n,) without gaps, or its ``slope`` per sample, by local polynomials that keep frequencies below ``cutoff``.

    Args:
        cutoff: in cycles per sample.
    """
    half = half_width(cutoff, len(y))
    if half < 2 and not slope:
        return y
    half = max(half, 2)
    if 2 * half + 1 > len(y):
        return np.gradient(y) if slope else y
    place = np.arange(-half, half + 1)
    fit = pseudo_inverse(np.vander(place, ORDER + 1, increasing=True))  # (ORDER + 1, L): coefficients by power
    inside = np.convolve(y, fit[int(slope)][::-1], "valid")
    begin, end = (polynomial.polyder(fit @ part, int(slope)) for part in (y[: len(place)], y[-len(place) :]))
    return np.concatenate([polynomial.polyval(place[:half], begin), inside, polynomial.polyval(place[-half:], end)])


def half_width(cutoff: float, samples: int) -> int:
    """Samples on one side of a local polynomial that keeps frequencies below ``cutoff`` (cycles per sample)."""
    begin = MARGIN * max(cutoff, 1e-6)
    wide = ((ORDER + 1) / (2 * begin) + 4.6) / 3.2
    return int(min(wide, WIDEST * samples)) if begin < 0.5 else 0


def _spectrum(y: np.ndarray, segment: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies in cycles per sample and the power there: a mean over stretches that overlap by half, without their trends.

    With the Blackman-Harris window, so that strong lines stay narrow.

    Source: P. D. Welch, IEEE Trans. Audio and Electroacoustics 15, 1967; F. J. Harris, Proceedings of the IEEE 66(1), 1978.
    """
    first = np.arange(0, len(y) - segment + 1, max(1, segment // 2))
    parts = y[first[:, None] + np.arange(segment)]
    line = np.vander(np.linspace(-1, 1, segment), 2)
    parts = parts - (parts @ pseudo_inverse(line).T) @ line.T
    angle = 2 * np.pi * np.arange(segment) / segment
    window = 0.35875 - 0.48829 * np.cos(angle) + 0.14128 * np.cos(2 * angle) - 0.01168 * np.cos(3 * angle)
    return np.fft.rfftfreq(segment), (np.abs(np.fft.rfft(parts * window)) ** 2).mean(axis=0)
