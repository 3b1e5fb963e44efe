"""Gaps in time stamps: the logger wrote nothing for a while, and nobody knows what drove the machine then."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SAMPLES_LOST = 5
"""Samples that may be missing one after the other before that is a gap: a lost message or two changes nothing."""

_FEW = 0.01
"""Share of the steps up to which long ones are gaps. Where more are long, the logger writes whenever something changes."""


@dataclass(frozen=True)
class Gap:
    """The longest gap of a recording: ``seconds`` without a sample after sample ``after``, which was at ``begin`` and is followed by one
    at ``end`` (s). ``count`` gaps in all; ``step`` is the usual time between samples.
    """

    after: int
    begin: float
    end: float
    step: float
    count: int

    @property
    def seconds(self) -> float:
        return self.end - self.begin

    def __str__(self) -> str:
        others = f", the longest of {self.count} gaps" if self.count > 1 else ""
        return (
            f"gap in the time stamps: no sample for {self.seconds:.4g} s, from {self.begin:.6g} to {self.end:.6g} s (after sample "
            f"{self.after}, the first is 0; usual step {self.step:.4g} s){others}"
        )


def longest_gap(time: NDArray[np.float64]) -> Gap | None:
    """The longest gap of increasing time stamps (N,), in s; None where there is none, or where long steps are the rule."""
    steps = np.diff(time)
    step = float(np.median(steps))
    long = steps > (SAMPLES_LOST + 1.5) * step
    if not long.any() or long.sum() > max(1.0, _FEW * len(steps)):
        return None
    k = int(np.argmax(steps))
    return Gap(k, float(time[k]), float(time[k + 1]), step, int(long.sum()))


def without_gaps(time: NDArray[np.float64]) -> NDArray[np.float64]:
    """The steps (K,) of time stamps that are not gaps."""
    steps = np.diff(time)
    return steps[steps <= (SAMPLES_LOST + 1.5) * np.median(steps)] if longest_gap(time) is not None else steps
