"""Up to which frequency the inputs move a machine."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from greybox_torch.simulation.records import Records

MOST = 0.99
"""Share of an input's power that lies in the band which it excites."""


def excited_band(signal: np.ndarray, sample_time: float, share: float) -> float:
    """The frequency (Hz) below which an input (N,) has a ``share`` of its power, its mean left out."""
    power = np.cumsum(np.abs(np.fft.rfft(signal - signal.mean())) ** 2)
    index = int(np.searchsorted(power, share * power[-1]))
    return float(np.fft.rfftfreq(len(signal), sample_time)[index])


def excited_up_to(records: Records) -> float:
    """The angular frequency (rad/s) up to which any input of any experiment has most of its power; infinite where no input moves."""
    step = float(np.median(records.dt))
    highest = max((excited_band(one, step, MOST) for one in _moving(records)), default=0.0)
    return 2 * np.pi * highest if highest > 0 else float("inf")


def any_input_moves(records: Records) -> bool:
    """Whether any input moves within any experiment."""
    return any(True for _ in _moving(records))


def _moving(records: Records) -> Iterator[np.ndarray]:
    """The inputs (N,) of each experiment that move within it, zero where one is missing."""
    spans = [records.span(e) for e in range(len(records.first))]
    each = (np.nan_to_num(one[span]) for one in records.u for span in spans)
    return (one for one in each if np.ptp(one) > 0)
