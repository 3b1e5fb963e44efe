"""A first-order lag that may be shorter than a sample.

Steps of a fixed length cannot follow a lag that is much shorter than they are, and samples do not tell it from a delay of the same
length: of such a lag nothing but its mean delay shows. Below ``SHORTEST`` samples the law therefore keeps the time constant and mixes the
signal itself in, so that the mean delay is T all the way down to zero.
"""

from __future__ import annotations

from typing import Any

import torch

SHORTEST = 0.45
"""Samples below which a time constant is not followed: Runge-Kutta steps of one sample are stable from 0.36 on."""


def lag_rate(signal: Any, lagged: Any, time_constant: Any, sample_time: float) -> Any:
    """Rate of the lagged signal: (signal − lagged) / T, with T no shorter than can be followed."""
    return (signal - lagged) / torch.clamp(time_constant, min=SHORTEST * sample_time)


def lag_change(signal: Any, lagged: Any, time_constant: Any, sample_time: float) -> Any:
    """What the lag changes of the signal: lagged − signal, of which less and less remains below what can be followed."""
    return torch.clamp(time_constant / (SHORTEST * sample_time), max=1.0) * (lagged - signal)
