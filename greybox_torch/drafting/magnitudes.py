"""Slips of unit that sizes give away: a speed that is not the rate of the position beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from greybox_torch.drafting.matching import Wanted
from greybox_torch.linear_algebra import least_squares

_SLIPS = {
    math.degrees(1.0): ("position", "deg"),
    math.radians(1.0): ("speed", "deg/s"),
    math.tau / 60.0: ("speed", "rpm"),
    1e3: ("position", "mm"),
    1e-3: ("speed", "mm/s"),
    1 / math.tau: ("position", "turn"),
}
"""What the ratio of the change of position to the integral of speed says of the unit of one of them."""

_CLOSE, _CORRELATED = 0.1, 0.9


def slips(
    pairs: Sequence[tuple[Wanted, Wanted]],
    columns: Mapping[str, NDArray[np.float64]],
    found: Mapping[str, str],
    time: NDArray[np.float64],
) -> dict[str, str]:
    """By channel, the unit that its column seems to be in.

    Args:
        pairs: positions with their speeds.
        columns: samples (N,) by column; ``found`` the column of each channel.
        time: seconds (N,).
    """
    told = {}
    for position, speed in pairs:
        if position.name not in found or speed.name not in found:
            continue
        ratio = _ratio(columns[found[position.name]], columns[found[speed.name]], time)
        for known, (which, unit) in _SLIPS.items():
            if ratio is not None and abs(ratio / known - 1.0) < _CLOSE:
                told[(position if which == "position" else speed).name] = unit
    return told


def _ratio(position: NDArray[np.float64], speed: NDArray[np.float64], time: NDArray[np.float64]) -> float | None:
    """The slope of position over the integral of speed; None where they hardly belong together."""
    if np.isnan(position).any() or np.isnan(speed).any():
        return None
    passed = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    trend = np.vander((time - time[0]) / max(time[-1] - time[0], 1e-12), 2)  # an offset of the speed is no matter
    left, right = (v - trend @ least_squares(trend, v) for v in (position, passed))
    power = float(right @ right)
    if power <= 0.0 or abs(float(left @ right)) < _CORRELATED * math.sqrt(power * float(left @ left)):
        return None
    return float(left @ right) / power
