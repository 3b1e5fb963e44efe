"""Where a record may begin, for effects that depend on a position which no sensor sees."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.mechanisms.local_signals import LocalSignals
from greybox_torch.mechanisms.mechanism import Mechanism

OFFSETS = sorted(np.linspace(-0.9, 0.9, 37), key=abs)
"""Start positions tried, in shares of the travel, where an effect acts at one place."""

START_POSITIONS = 12
"""Start positions tried over one period."""


def position_trials(local: LocalSignals, values: Mapping[str, float]) -> list[dict[str, float]]:
    """Start positions of the bodies whose position no sensor shows: over one period of the slowest periodic effect, or over the travel."""
    states = local.unseen_positions()
    placed = [a for a in local.attachments if a.position]
    if any(not _periodic(a.mechanism) for a in placed):
        travel = [local.surroundings[a.port].ranges["position"] for a in placed]
        span = max(r.high - r.low for r in travel)
        return [{s: float(share) * span for s in states} for share in OFFSETS]
    orders = [abs(float(values.get(f"{a.prefix}.order", 1.0))) for a in placed]
    period = 2 * np.pi / max(min(orders), 1e-9)
    return [dict.fromkeys(states, k * period / START_POSITIONS) for k in range(START_POSITIONS)]


def _periodic(mechanism: Mechanism) -> bool:
    return hasattr(mechanism, "order") or mechanism.name == "gravity"
