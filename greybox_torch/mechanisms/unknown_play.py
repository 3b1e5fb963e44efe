"""Play between the recorded input and what acts: the answer `unknown` at an actuator that remembers which way it was moved last."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.input_follower import Drawn, InputFollower
from greybox_torch.mechanisms.mechanism import SHARE, Probe, Surroundings
from greybox_torch.model import Parameter, Signals

LOOKS = (0.01, 0.03, 0.1)
"""Half widths that the screen looks at, in shares of how far the input moved."""


class UnknownPlay(InputFollower):
    """What acts stands still until the input has come back by the width 2 h of the play, and then follows it at a distance of h.

    A linkage with play, a valve that sticks in its packing.
    """

    name = "unknown_play"
    essential = ("h",)
    nature = "play"
    explanation = (
        "What acts stands still until the input has come back by 2 h (a linkage with play, a valve that sticks)."
    )
    source = "M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis, 1989"
    experiment = "slow triangles of the input of several sizes, each several times"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        unit, span = around.units.get("input", ""), around.ranges["input"].span
        return [Parameter("h", 0.03 * span, unit, lower=0.0, upper=0.5 * span, description="half width of the play")]

    def rate(self, ahead: Any, p: Signals, follows: float) -> Any:
        beyond = torch.where(ahead > p.h, ahead - p.h, torch.where(ahead < -p.h, ahead + p.h, 0.0))
        return beyond / follows

    def drawn(self, around: Surroundings, values: Mapping[str, float], points: int) -> Drawn:
        """The loop over the input."""
        there = np.linspace(around.ranges["input"].low, around.ranges["input"].high, points)
        both, lacking = np.concatenate([there, there[::-1]]), np.repeat([-values["h"], values["h"]], points)
        return "input", around.units.get("input", ""), both, lacking, around.force_unit

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((SHARE,), {"h": look * around.ranges["input"].span}) for look in LOOKS]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        moved = around.ranges["input"].span
        return (
            f"h = {values['h']:.3g} is a third of how far the input moved, or more" if values["h"] > moved / 3 else None
        )
