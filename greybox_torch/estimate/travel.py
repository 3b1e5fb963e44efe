"""The way of a body whose position no state of the model is, and which ways signals go."""

from __future__ import annotations

import numpy as np

from greybox_torch.simulation.records import Records

BACK = 0.2
"""Part of its travel that a body has to go a second time to have come back."""

SELDOM, LITTLE = 0.01, 0.02
"""Share of the samples, and of how far a signal goes to one side, that do not count as its other side."""


def integrated(speed: np.ndarray, records: Records) -> np.ndarray:
    """Positions (N,) from speeds (N,), which begin at zero in every experiment."""
    pieces = []
    for e in range(len(records.lengths)):
        span = records.span(e)
        pieces.append(np.concatenate([[0.0], np.cumsum(speed[span][:-1] * records.dt[span][:-1])]))
    return np.concatenate(pieces)


def comes_back(position: np.ndarray, records: Records) -> bool:
    """Whether a body is anywhere twice within an experiment, to speak of.

    One that goes one way alone passes each place once, as a clock does: what a curve over its position says is what happened when.
    """
    ways = [position[records.span(e)] for e in range(len(records.lengths))]
    return any(np.abs(np.diff(way)).sum() > (1.0 + BACK) * np.ptp(way) for way in ways if len(way) > 1)


def either_way(values: np.ndarray) -> bool:
    """Whether a signal is on either side of zero, to speak of."""
    known = values[np.isfinite(values)]
    if not len(known):
        return False
    low, high = np.quantile(known, [SELDOM, 1.0 - SELDOM])
    return bool(min(-low, high) > LITTLE * max(-low, high))
