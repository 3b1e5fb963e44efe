"""The order of a periodic force that a learned curve over position draws."""

from __future__ import annotations

import numpy as np

from greybox_torch.linear_algebra import least_squares

MOST_PERIODS = 20
"""Periods over the curve's range up to which they are looked for: a curve has not the bumps for more."""

STEPS_PER_PERIOD = 8


def order_of_curve(position: np.ndarray, force: np.ndarray, weight: np.ndarray) -> float | None:
    """The order n, in periods per 2π of position, at which a cos nθ + b sin nθ beside a parabola comes nearest to a curve.

    The parabola stands for what the model's own parameters (a gravity, a spring) took up while the curve was learned. None where the
    curve has no range.

    Args:
        position: where the curve is known (N,), evenly spaced, in rising order.
        force: its height there (N,).
        weight: what each point counts (N,).
    """
    span = float(position[-1] - position[0])
    if not span > 0.0:
        return None
    root, place = np.sqrt(weight), 2.0 * (position - position[0]) / span - 1.0
    slow = np.stack([np.ones_like(place), place, place**2], axis=1)

    def left(order: float) -> float:
        columns = np.column_stack([slow, np.cos(order * position), np.sin(order * position)]) * root[:, None]
        return float(np.sum((force * root - columns @ least_squares(columns, force * root)) ** 2))

    periods = np.arange(1.0, MOST_PERIODS, 1.0 / STEPS_PER_PERIOD)
    return float(min(2.0 * np.pi * periods / span, key=left))
