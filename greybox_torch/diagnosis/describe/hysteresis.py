"""The loop that a hysteretic spring draws: its force over the deflection, to one end of what was recorded and back."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import torch

from greybox_torch.diagnosis.effect import Curve
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.transmission import HystereticSpring
from greybox_torch.model import Signals

SETTLED = 12.0
"""Deflections at which it slips, behind a reversal, after which the force stays as it is."""
STEPS = 240
"""Over that stretch."""
CLOSED, MOST_ROUNDS = 1e-3, 20
"""Share of that deflection up to which a round that ends where it began is the loop, and after how many rounds any is."""


def hysteresis_loop(mechanism: HystereticSpring, around: Surroundings, values: Mapping[str, float]) -> Curve | None:
    """The force over the deflection, each way; it does not depend on how fast. None where no deflection is known.

    Args:
        values: of its parameters, by short names.
    """
    span = around.ranges.get("deflection")
    if span is None or not span.span > 0.0:
        return None
    reach = min(SETTLED * values["z_0"], span.span)
    way = np.linspace(0.0, reach, STEPS + 1)
    p = Signals("parameter", values)
    loop, begun = _once(mechanism, p, way, 0.0), 0.0
    for _ in range(MOST_ROUNDS):
        if abs(loop[1][-1] - begun) <= CLOSED * values["z_0"]:
            break
        begun = float(loop[1][-1])
        loop = _once(mechanism, p, way, begun)
    force = np.concatenate([_force(mechanism, p, np.append(w, w[-1])) for w in loop])
    up = np.append(span.low + way, span.high)
    return Curve(
        "deflection",
        around.units.get("deflection", ""),
        np.concatenate([up, span.high + span.low - up]),
        force,
        around.force_unit,
    )


def _once(mechanism: HystereticSpring, p: Signals, way: np.ndarray, slip: float) -> tuple[np.ndarray, np.ndarray]:
    """Its memory on the way up and on the way down, begun with ``slip``."""
    up = _along(mechanism, p, 1.0, way, slip)
    return up, _along(mechanism, p, -1.0, way, float(up[-1]))


def _along(mechanism: HystereticSpring, p: Signals, direction: float, way: np.ndarray, slip: float) -> np.ndarray:
    """Its memory (n,) on a ``way`` (n,) in one direction: Heun's rule."""
    found = [slip]
    for step in np.diff(way):
        here = _slope(mechanism, p, direction, found[-1])
        ahead = _slope(mechanism, p, direction, found[-1] + step * here)
        found.append(found[-1] + 0.5 * step * (here + ahead))
    return np.array(found)


def _slope(mechanism: HystereticSpring, p: Signals, direction: float, slip: float) -> float:
    s, z = (
        Signals(kind, {name: torch.tensor(v, dtype=torch.float64)})
        for kind, name, v in (("local", "rate", direction), ("memory", "slip", slip))
    )
    return float(mechanism.rates(s, p, z)["slip"])


def _force(mechanism: HystereticSpring, p: Signals, slip: np.ndarray) -> np.ndarray:
    none = Signals("local", {})
    return np.asarray(mechanism.force(none, p, Signals("memory", {"slip": torch.as_tensor(slip)})), dtype=float)
