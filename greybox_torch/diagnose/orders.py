"""Finding the order of a periodic effect from the data, at any order that the sampling resolves.

The phase of a periodic effect is coherent over a whole record only if its order is known to a fraction of one over the travel. So the
scan is incoherent first: every window has a phase of its own, and the peak over a coarse grid of orders is broad. Then, around the
highest peaks, a coherent look over the record gives the order finely.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from greybox_torch.diagnose.screen import Screen
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import TorqueRipple
from greybox_torch.mechanisms.friction import PositionDependentFriction
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.model import Body, GreyBoxModel

LEAST_PERIODS = 5.0
"""Periods within the travel from which an effect is seen to repeat; anything slow could otherwise pass for periodic."""

BATCH = 32
"""Orders looked at in one compiled pass."""


def scan_orders(
    base: GreyBoxModel,
    accepted: Sequence[Attachment],
    surroundings: Mapping[str, Surroundings],
    free_names: Sequence[str],
    fitted: WindowFit,
    *,
    substeps: int,
    device: str = "cpu",
    peaks: int = 2,
) -> list[float]:
    """The most promising orders (periods per unit of position) of a periodic effect at the first body, best first."""
    body = next((p for p in base.ports if isinstance(p, Body)), None)
    if body is None:
        return []
    around = surroundings[body.name]
    found: list[tuple[float, float]] = []
    for family in (TorqueRipple, PositionDependentFriction):
        attachments = [Attachment(body.name, family(), position=body.name)] * BATCH
        screen = Screen.of(base, accepted, attachments, surroundings, free_names, device=device)
        grid = _grid(around, fitted)
        if len(grid) < 4:
            return []
        scores = np.concatenate([_incoherent(screen, fitted, part, substeps) for part in _batches(grid)])
        for k in _highest(scores, peaks):
            found.append(_refined(screen, fitted, float(grid[k]), float(grid[1] - grid[0]), substeps))
    found.sort(reverse=True)
    return distinct_orders(order for _, order in found)


def distinct_orders(orders: Iterable[float]) -> list[float]:
    """Orders in the sequence given, without those within 5 % of one before."""
    kept: list[float] = []
    for order in orders:
        if all(abs(order - other) > 0.05 * other for other in kept):
            kept.append(order)
    return kept


def _grid(around: Surroundings, fitted: WindowFit) -> np.ndarray:
    """Orders from a little above zero to what the sampling resolves, as fine as the travel within a window asks for."""
    position, speed = around.ranges["position"], around.ranges["speed"]
    travel = max(speed.rms * around.sample_time * fitted.windows.steps, 1e-9)
    highest = 1.0 / max(speed.rms * around.sample_time, 1e-12)
    one = 2 * np.pi / max(position.high - position.low, 1e-9)
    step = max(1.5 / travel, one / 2)
    return np.arange(max(LEAST_PERIODS * one, step / 2), min(highest, 400 * step), step)


def _batches(grid: np.ndarray) -> list[np.ndarray]:
    return [grid[k : k + BATCH] for k in range(0, len(grid), BATCH)]


def _at_orders(screen: Screen, orders: np.ndarray) -> Screen:
    filled = np.concatenate([orders, np.full(BATCH - len(orders), orders[-1])])
    return screen.with_probes([{"order": float(order)} for order in filled])


def _incoherent(screen: Screen, fitted: WindowFit, orders: np.ndarray, substeps: int) -> np.ndarray:
    """Share of the residual explained when every window has its own amplitude and phase."""
    normal = _at_orders(screen, orders).matrices(fitted, substeps)
    n_p, total = len(screen.free_names), float(normal[:, -1, -1].sum())
    shares = []
    for k in range(len(orders)):
        columns = np.arange(n_p + 2 * k, n_p + 2 * k + 2)
        inner = normal[:, columns[:, None], columns[None, :]]
        trace = np.trace(inner, axis1=1, axis2=2)
        inner = inner + (1e-6 * trace + 1e-300)[:, None, None] * np.eye(2)
        right = normal[:, columns, -1]
        shares.append(float((right * np.linalg.solve(inner, right[..., None])[..., 0]).sum()) / max(total, 1e-300))
    return np.array(shares)


def _refined(screen: Screen, fitted: WindowFit, order: float, step: float, substeps: int) -> tuple[float, float]:
    """The best coherent share near ``order``, and the order where it is."""
    best = (-np.inf, order)
    width = step
    for _ in range(3):
        orders = np.linspace(max(best[1] - width, 1e-3), best[1] + width, BATCH)
        looks = _at_orders(screen, orders).look(fitted, substeps)
        k = int(np.argmax([look.explained for look in looks]))
        best = (looks[k].explained, float(orders[k]))
        width = 2.5 * width / BATCH
    return best


def _highest(scores: np.ndarray, count: int) -> list[int]:
    """Indices of the highest local maxima."""
    padded = np.concatenate([[-np.inf], scores, [-np.inf]])
    tops = np.flatnonzero((padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:]))
    return [int(k) for k in tops[np.argsort(-scores[tops])][:count]]
