"""Finding the order of a periodic effect from the data, at any order that the sampling resolves.

The phase of a periodic effect is coherent over a whole record only if its order is known to a fraction of one over the travel. So the
scan is incoherent first: every window has a phase of its own, and the peak over a coarse grid of orders is broad. Then, around the
highest peaks, a coherent look over the record gives the order finely.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

import numpy as np

from greybox_torch.diagnosis.screen.score_test import Screen
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.linear_algebra import solve
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.varying_friction import PositionDependentFriction
from greybox_torch.model import Body
from greybox_torch.simulation.side_by_side import side_by_side

BATCH = 32
"""Orders looked at in one compiled pass."""

FAMILIES: tuple[type[Mechanism], ...] = (TorqueRipple, PositionDependentFriction)
"""What the scan looks for; at further bodies for the first alone."""


def scan_orders(
    study: Study, accepted: Sequence[Attachment], free_names: Sequence[str], fits: Sequence[WindowFit]
) -> dict[str, list[float]]:
    """By body, the most promising orders (periods per unit of position) of a periodic effect: at the first body, and at those that move
    otherwise, as the second joint of an arm or the other drum of a winder.

    Of every fit (they differ in window length), the two that explain most, best first.
    """
    bodies = _moving_otherwise(study)
    return {
        body.name: _orders_at(study, body, FAMILIES if k == 0 else FAMILIES[:1], accepted, free_names, fits)
        for k, body in enumerate(bodies)
    }


def _moving_otherwise(study: Study) -> list[Body]:
    """The first body, and those of which none before them has the same travel: what turns as another does repeats at the same orders.

    Seen: the teeth of a winder's motor, looked for at the orders of the other drum alone, and told as the sheet's and that drum's.
    """
    differ, kept = study.settings.orders_differ, dict[float, Body]()
    for body in (port for port in study.problem.model.ports if isinstance(port, Body)):
        position = study.surroundings[body.name].ranges["position"]
        travel = position.high - position.low
        if all(abs(travel - other) > differ * max(travel, other) for other in kept):
            kept[travel] = body
    return list(kept.values())


def _orders_at(
    study: Study,
    body: Body,
    families: Sequence[type[Mechanism]],
    accepted: Sequence[Attachment],
    free_names: Sequence[str],
    fits: Sequence[WindowFit],
) -> list[float]:
    base, settings, budget = study.problem.model, study.settings, study.budget

    def screen(family: type[Mechanism]) -> Screen:
        attachments = [Attachment(body.name, family(), position=body.name)] * BATCH
        return Screen.of(base, accepted, attachments, study.surroundings, free_names, study.options)

    around = study.surroundings[body.name]
    grids = [(fit, grid) for fit in fits if len(grid := _grid(around, fit, study)) >= 4]
    screens = side_by_side(partial(screen, family) for family in families) if grids else []
    pairs = [(one, fit, grid) for fit, grid in grids for one in screens]
    peaks_of = side_by_side(partial(_peaks, *pair, budget.order_peaks) for pair in pairs)
    orders = []
    for fit, _ in grids:
        own = [peak for (_, of, _), some in zip(pairs, peaks_of, strict=True) if of is fit for peak in some]
        orders += distinct_orders((order for _, order in sorted(own, reverse=True)), settings.orders_differ)[
            : budget.order_peaks
        ]
    return distinct_orders(orders, settings.orders_differ)


def _peaks(screen: Screen, fitted: WindowFit, grid: np.ndarray, count: int) -> list[tuple[float, float]]:
    """The highest peaks over a grid of orders: shares explained, and orders."""
    starts = _at_orders(screen, grid[:BATCH]).starts(fitted)  # an order changes no memory
    scores = np.concatenate([_incoherent(screen, fitted, part, starts) for part in _batches(grid)])
    step = float(grid[1] - grid[0])
    return [_refined(screen, fitted, float(grid[k]), step, starts) for k in _highest(scores, count)]


def distinct_orders(orders: Iterable[float], differ: float) -> list[float]:
    """Orders in the sequence given, without those that differ relatively by ``differ`` or less from one before."""
    kept: list[float] = []
    for order in orders:
        if all(abs(order - other) > differ * other for other in kept):
            kept.append(order)
    return kept


def _grid(around: Surroundings, fitted: WindowFit, study: Study) -> np.ndarray:
    """Orders from a little above zero to what the sampling resolves, as fine as the travel within a window asks for.

    At the usual speed the highest passes in three samples: it acts where the machine is slower, and slower it is for half of the time.
    """
    position, speed = around.ranges["position"], around.ranges["speed"]
    travel = max(speed.rms * around.sample_time * fitted.windows.steps, 1e-9)
    highest = 2.0 / max(speed.rms * around.sample_time, 1e-12)
    one = 2 * np.pi / max(position.high - position.low, 1e-9)
    step = max(1.5 / travel, one / 2)
    return np.arange(
        max(study.settings.least_periods * one, step / 2), min(highest, study.budget.order_steps * step), step
    )


def _batches(grid: np.ndarray) -> list[np.ndarray]:
    return [grid[k : k + BATCH] for k in range(0, len(grid), BATCH)]


def _at_orders(screen: Screen, orders: np.ndarray) -> Screen:
    filled = np.concatenate([orders, np.full(BATCH - len(orders), orders[-1])])
    return screen.with_probes([{"order": float(order)} for order in filled])


def _incoherent(screen: Screen, fitted: WindowFit, orders: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Share of the residual explained when every window has its own amplitude and phase."""
    projected = _at_orders(screen, orders).projected(fitted, starts)
    first = len(screen.free_names) + 2 * np.arange(len(orders))
    inner, right = projected.blocks(np.stack([first, first + 1], axis=1))
    trace = np.trace(inner, axis1=2, axis2=3)
    inner = inner + (1e-6 * trace + 1e-300)[..., None, None] * np.eye(2)
    explained = (right * solve(inner, right[..., None])[..., 0]).sum(axis=(0, 2))
    return explained / max(projected.energy(), 1e-300)


def _refined(screen: Screen, fitted: WindowFit, order: float, step: float, starts: np.ndarray) -> tuple[float, float]:
    """The best coherent share near ``order``, and the order where it is."""
    best = (-np.inf, order)
    width = step
    for _ in range(3):
        orders = np.linspace(max(best[1] - width, 1e-3), best[1] + width, BATCH)
        scores = _at_orders(screen, orders).scores(fitted, starts)
        k = int(np.argmax([score.explained for score in scores]))
        best = (scores[k].explained, float(orders[k]))
        width = 2.5 * width / BATCH
    return best


def _highest(scores: np.ndarray, count: int) -> list[int]:
    """Indices of the highest local maxima."""
    padded = np.concatenate([[-np.inf], scores, [-np.inf]])
    tops = np.flatnonzero((padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:]))
    return [int(k) for k in tops[np.argsort(-scores[tops])][:count]]
