"""An input that acts later: what records has to carry for it."""

from __future__ import annotations

from typing import Any

import numpy as np

from greybox_torch.mechanisms.mechanism import Mechanism

CHANNELS = ("delayed", "slope", "delay")
"""What an input that acts later adds to a model's inputs: its value at the present delay, the slope by the delay, and that delay."""


def channels(mechanism: Mechanism) -> list[list[str]]:
    """For every input that a law delays, the one of its own port first, what its channels are called."""
    return [[f"{name}{end}" for name in CHANNELS] for end in ("", *(f"@{other}" for other in mechanism.drives))]


def after(records: Any, delay: float) -> np.ndarray:
    """Which samples (N,) lie ``delay`` s or more behind the beginning of their record."""
    return np.concatenate([(time := records.time(e)) - time[0] >= delay for e in range(len(records.first))])


def delayed(records: Any, channel: int, delay: float) -> list[np.ndarray]:
    """An input shifted later by ``delay`` s (linear between samples, held before the record), its slope, and the delay."""
    value, slope = np.empty(records.u.shape[1]), np.empty(records.u.shape[1])
    for e in range(len(records.first)):
        span = records.span(e)
        time, signal = records.time(e), records.u[channel, span]
        value[span] = np.interp(time - delay, time, signal)
        rate = np.append(np.diff(signal) / np.diff(time), 0.0)
        index = np.clip(np.searchsorted(time, time - delay, side="right") - 1, 0, len(time) - 1)
        slope[span] = np.where(time - delay < 0, 0.0, -rate[index])
    return [value, slope, np.full(records.u.shape[1], delay)]
