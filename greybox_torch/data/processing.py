"""What is done to samples only where a card asks for it: resampling, derivatives, decimation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.steps import usual_step
from greybox_torch.errors import UserError

Samples = NDArray[np.float64]
_PADDING = 200  # reflected samples at the ends
_LEAST_WEIGHT = 0.25  # at the ends of a recording it is a half
_LOWEST_CUTOFF = 1e-7  # of the sampling rate: below it the filter's poles are one in double precision


def even_grid(time: Samples, step: float, place: str) -> Samples:
    """Time stamps from the first one on, `step` seconds apart, as far as the recording goes.

    Raises UserError where that would be fewer than two, or more than a hundred for each sample that there is.
    """
    count = np.floor((time[-1] - time[0]) / step * (1 + 1e-12)) + 1
    if not 2 <= count <= 100 * len(time) + 100:
        raise UserError(
            f"{place}: resample = {step:g} s makes {count:g} samples of {len(time)}; the usual step of the recording is "
            f"{usual_step(time):.6g} s"
        )
    return time[0] + np.arange(int(count)) * step


def at_times(times: Samples, stamps: Samples, values: Samples) -> Samples:
    """`values`, known at `stamps`, at other times: on straight lines between samples, NaN beside them and next to a missing one."""
    found = np.interp(times, stamps, values, left=np.nan, right=np.nan)
    exact = np.minimum(np.searchsorted(stamps, times), len(stamps) - 1)
    return np.where(stamps[exact] == times, values[exact], found)


SLOWER = 1.5
"""Times as long steps from which samples of another file stand for a measurement only where they were taken."""


def between_samples(times: Samples, stamps: Samples) -> NDArray[np.bool_] | None:
    """Which of `times` are nearest to none of the slower `stamps`; None where those are not slower.

    A straight line between two samples has their noise once, not in every sample: what is judged by noise would count it as many times.
    """
    if len(times) < 2 or len(stamps) < 2 or np.median(np.diff(stamps)) < SLOWER * np.median(np.diff(times)):
        return None
    after = np.clip(np.searchsorted(times, stamps), 1, len(times) - 1)
    nearest = after - (stamps - times[after - 1] < times[after] - stamps)
    inside = (stamps >= times[0]) & (stamps <= times[-1])
    return ~np.isin(np.arange(len(times)), nearest[inside])


def _missing(sample: int) -> str:
    return f"sample {sample} (the first is 0) is missing; expected no gap where a derivative is asked for"


def derivative(
    values: Samples, step: float, cutoff: float, place: str, missing_at: Callable[[int], str] = _missing
) -> Samples:
    """The rate of change of even samples, per second: central differences behind a low pass without delay.

    The filter is a Butterworth of second order at `cutoff` Hz, run forward and backward over the samples and their odd reflection at the
    ends. `missing_at` says of a missing sample where it is.

    Raises UserError where a sample is missing, the recording is too short, or the cut-off lies above half the sampling rate or near zero.
    """
    from scipy import signal

    if not cutoff < 0.5 / step:
        raise UserError(
            f"{place}: a cut-off of {cutoff:g} Hz; expected less than half the sampling rate, {0.5 / step:g} Hz"
        )
    missing = np.flatnonzero(np.isnan(values))
    if missing.size:
        raise UserError(f"{place}: {missing_at(int(missing[0]))}")
    if not cutoff > _LOWEST_CUTOFF / step:
        raise UserError(
            f"{place}: a cut-off of {cutoff:g} Hz is too far below the sampling rate for numbers of 16 digits; expected more than "
            f"{_LOWEST_CUTOFF / step:g} Hz"
        )
    sections: Any = signal.butter(2, cutoff, fs=1.0 / step, output="sos")
    return np.gradient(signal.sosfiltfilt(sections, values, padtype="odd", padlen=min(len(values) - 1, _PADDING)), step)


def decimated(values: Samples, factor: int) -> Samples:
    """Every `factor`-th of even samples, behind a low pass against aliasing that keeps constants and has no delay.

    The filter is a window-designed low pass (Hamming, 20 `factor` + 1 taps, cut off at the new half sampling rate). Missing samples carry
    no weight, and stay missing where they are kept.
    """
    from scipy import signal

    taps = signal.firwin(20 * factor + 1, 1.0 / factor, window="hamming")
    known = ~np.isnan(values)
    padding = len(taps) // 2
    weight = signal.fftconvolve(np.pad(known.astype(float), padding), taps, mode="valid")
    total = signal.fftconvolve(np.pad(np.where(known, values, 0.0), padding), taps, mode="valid")
    with np.errstate(invalid="ignore", divide="ignore"):
        filtered = np.where(known & (weight > _LEAST_WEIGHT), total / weight, np.nan)
    return filtered[::factor]
