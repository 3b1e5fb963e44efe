"""How far a bristle, or an elasto-slip element, has slipped, as a share of the deflection at which it slips."""

from __future__ import annotations

from typing import Any

import torch

MOST = 2.0
"""Share beyond which the rate changes no more. It is at most one, but where a step is too long for a fast motion."""


def slip_share(slip: Any, z_0: Any) -> Any:
    """z / z_0, bounded, so that an element which the steps of a fast motion overshoot stays finite and comes back."""
    return torch.clamp(slip / z_0, -MOST, MOST)
