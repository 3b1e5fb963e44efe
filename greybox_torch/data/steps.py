"""The usual step of time stamps, and how even they are. What floats round of the stamps is no step of the logger's.

Seconds since 1970 hold a quarter of a microsecond: stamps 0.1 ms apart differ by 0.09990 or 0.10014 ms, and seldom by what they stand for.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.gaps import gap_steps, lost_samples, without_gaps

EVEN = 0.01
"""Time stamps are even where no step differs from the usual one by more than this share."""

_HELD = 1e-6
"""Share of a step that floats have to hold: stamps that hold more are taken as they are."""


def usual_step(time: NDArray[np.float64]) -> float:
    """The median step (s) of increasing time stamps (N,); the mean one of stamps that are even as far as floats tell, but for gaps, as
    one would write it.
    """
    mean = _even(time)
    return float(np.median(np.diff(time))) if mean is None else mean


def steps_of(time: NDArray[np.float64]) -> NDArray[np.float64]:
    """The steps (N - 1,) of increasing time stamps (N,) in s; those of stamps that are even as far as floats tell are the usual one."""
    steps, mean = np.diff(time), _even(time)
    return steps if mean is None else np.where(np.abs(steps - mean) <= _rounded(time), mean, steps)


def unevenness(time: NDArray[np.float64], *, gaps: bool = True, lost: bool = True) -> float:
    """The largest deviation of a step from the usual one, as a share of it. Without `gaps`, steps that are gaps do not count; without
    `lost`, those over single samples that are missing do not.
    """
    step, steps = usual_step(time), steps_of(time)
    counted = np.ones(len(steps), dtype=bool) if gaps else ~gap_steps(time)
    if not lost:
        counted[[one.after for one in lost_samples(time)]] = False
    return float(np.max(np.abs(steps[counted] - step), initial=0.0) / step)


def even_step(time: NDArray[np.float64]) -> str:
    """The step (s) of an even grid for increasing time stamps (N,), as one would write it: the mean but for holes, rounded where near."""
    steps = np.diff(time)
    mean = float(np.mean(steps[steps < 1.5 * np.median(steps)]))
    return f"{mean:.2g}" if abs(float(f"{mean:.2g}") / mean - 1.0) < EVEN else f"{mean:.4g}"


def _even(time: NDArray[np.float64]) -> float | None:
    """The mean step but for gaps, where floats round steps noticeably and all agree with it as far as they tell.

    Of the numbers that it may be, the shortest. Seen: a step of 2 ms, told as 0.00199999998 s in the files of a design.
    """
    rounded, steps = _rounded(time), without_gaps(time)
    if not len(steps) or rounded <= _HELD * np.median(steps):
        return None
    mean = float(np.mean(steps))
    stretches = len(time) - len(steps)  # of each the first stamp and the last are rounded
    return _shortest(mean, rounded * stretches / len(steps)) if np.abs(steps - mean).max() <= rounded else None


def _shortest(value: float, uncertain: float) -> float:
    """The number of fewest digits that is no farther from ``value`` than is ``uncertain``."""
    written = (float(f"{value:.{digits}e}") for digits in range(16))
    return next((number for number in written if abs(number - value) <= uncertain), value)


def _rounded(time: NDArray[np.float64]) -> float:
    """By how much a step may differ for the rounding of its two stamps: each from nanoseconds to a float, and that to seconds."""
    return 2.0 * float(np.spacing(np.abs(time[[0, -1]]).max()))
