"""Measured signals smoothed without delay, each up to the frequency at which it disappears in its noise.

Signal and noise are differentiated alike, so that the frequency up to which a signal stands above its noise is the same for all of its
derivatives: beyond it a derivative is noise. What is below is kept by local cubic polynomials, which have no phase.

Source: M. Gautier, "Dynamic identification of robots with power model", IEEE ICRA, 1997, for derivatives by zero-phase filters with a
cut-off from the machine's bandwidth; A. Savitzky, M. J. E. Golay, Analytical Chemistry 36(8), 1964; R. W. Schafer, "What is a
Savitzky-Golay filter?", IEEE Signal Processing Magazine 28(4), 2011, for their cut-off frequency.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import savgol_filter, welch

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
    segment = min(LONGEST_SEGMENT, max(FEWEST, len(y) // 8))
    frequency, density = welch(
        y, nperseg=segment, detrend="linear", window="blackmanharris"
    )  # strong lines stay narrow
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
    length = 2 * max(half, 2) + 1
    if length > len(y):
        return np.gradient(y) if slope else y
    return np.asarray(savgol_filter(y, length, ORDER, deriv=int(slope)))


def half_width(cutoff: float, samples: int) -> int:
    """Samples on one side of a local polynomial that keeps frequencies below ``cutoff`` (cycles per sample)."""
    begin = MARGIN * max(cutoff, 1e-6)
    wide = ((ORDER + 1) / (2 * begin) + 4.6) / 3.2
    return int(min(wide, WIDEST * samples)) if begin < 0.5 else 0
