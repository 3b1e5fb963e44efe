"""Where a shaft stands within its turn."""

from __future__ import annotations

import math
from typing import Any

import torch

from greybox_torch.model.ports import Body, Signal, value_of

TURN = "turn"
"""The name of such a signal."""

TURN_OF = "turn@"
"""Beginning of the name of that of another port's body; the body's name follows."""

WHOLE = 2.0 * math.pi
"""A turn, in rad."""


def within_turn(body: Body, x: Any, u: Any, p: Any) -> Any:
    """The angle of a body's position beyond its last whole turn, rad."""
    position: Signal | None = body.position
    assert position is not None
    return torch.remainder(value_of(position, x, u, p), WHOLE)
