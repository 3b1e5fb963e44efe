"""Orders of a periodic effect from the force that is missing at a body: its spectrum over the position, all orders at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.screen.missing_force import MissingForce

PER_PERIOD = 4
"""Places of the grid of positions within a period of the highest order."""

PADDED = 2
"""How many times as fine as the travel asks for the orders are looked at."""

MOST_PLACES = 2**20
"""Of the grid of positions."""


@dataclass(frozen=True)
class Orders:
    """The orders (periods per unit of position times 2 π) that stand out most, best first, and of how many independent ones."""

    best: tuple[float, ...]
    looked_at: int


def orders_over_position(
    missing: MissingForce, highest: float, *, least_periods: float, count: int, with_motion: bool
) -> Orders:
    """The highest peaks of a missing force's spectrum over position, incoherent between experiments.

    Args:
        highest: the highest order, what sampling resolves at the usual speed.
        least_periods: within the travel, from which something is seen to repeat.
        count: how many peaks.
        with_motion: of the force along the motion, as friction whose level repeats; else of the force itself.
    """
    position = missing.signals["position"]
    force = missing.force * np.sign(missing.signals["speed"]) if with_motion else missing.force
    low, span = float(position.min()), float(np.ptp(position))
    lowest = 2 * np.pi * least_periods / max(span, 1e-12)
    places = int(min(MOST_PLACES, np.ceil(span * highest * PER_PERIOD / (2 * np.pi)) + 1))
    if not (np.isfinite(places) and lowest < highest and places > 2 * PER_PERIOD):
        return Orders((), 0)
    width = span / (places - 1)
    at = np.round((position - low) / width).astype(int)
    length = PADDED * places
    power = np.zeros(length // 2 + 1)
    for e in np.unique(missing.experiment):
        own = missing.experiment == e
        centred = force[own] - force[own].mean()
        power += np.abs(np.fft.rfft(np.bincount(at[own], weights=centred, minlength=places), length)) ** 2 / own.sum()
    orders = 2 * np.pi * np.arange(len(power)) / (length * width)
    inside = np.flatnonzero((orders >= lowest) & (orders <= highest))
    if len(inside) < 3:
        return Orders((), 0)
    tops = [k for k in inside[1:-1] if power[k] >= power[k - 1] and power[k] > power[k + 1]]
    best = sorted(tops, key=lambda k: -power[k])[:count]
    return Orders(tuple(float(orders[k]) for k in best), len(inside) // PADDED)
