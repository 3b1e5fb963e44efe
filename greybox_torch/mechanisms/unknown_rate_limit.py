"""A limit of how fast an actuator follows its input: the answer `unknown` at an actuator that lags the more, the more is asked of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.input_follower import Drawn, InputFollower
from greybox_torch.mechanisms.mechanism import SHARE, Probe, Surroundings
from greybox_torch.model import Parameter, Signals

LOOKS = (3.0, 10.0, 30.0, 100.0)
"""Samples in which what acts would cross the range of the input, at the limits that the screen looks at."""


class UnknownRateLimit(InputFollower):
    """What acts follows the input no faster than R, in its unit per second, either way.

    A servo of a control surface, the ramp of a drive, a valve's motor.
    """

    name = "unknown_rate_limit"
    essential = ("R",)
    nature = "a limit of its rate"
    explanation = "What acts follows the input no faster than R (a servo, the ramp of a drive, a valve's motor)."
    source = "R. Hess, S. Snell, Flight control system design with rate saturating actuators, J. Guidance 20, 1997"
    experiment = (
        "steps of the input of several sizes: a lag takes as long for each of them, a limit of the rate does not"
    )

    def parameters(self, around: Surroundings) -> list[Parameter]:
        unit, fastest = around.units.get("input", ""), _fastest(around)
        return [
            Parameter(
                "R",
                0.1 * fastest,
                f"{unit}/s",
                lower=1e-4 * fastest,
                upper=2.0 * fastest,
                description="limit of the rate",
            )
        ]

    def rate(self, ahead: Any, p: Signals, follows: float) -> Any:
        return torch.maximum(torch.minimum(ahead / follows, p.R), -p.R)

    def drawn(self, around: Surroundings, values: Mapping[str, float], points: int) -> Drawn:
        """What is lacking of the input's rate, over that rate."""
        limit = values["R"]
        rate = np.linspace(-3.0, 3.0, points) * limit
        unit = f"{around.units.get('input', '')}/s"
        return "rate of the input", unit, rate, np.clip(rate, -limit, limit) - rate, unit

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((SHARE,), {"R": _fastest(around) / look}) for look in LOOKS]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        told = f"R = {values['R']:.3g}: what acts would cross the range of the input"
        return f"{told} within a sample" if values["R"] >= _fastest(around) else None


def _fastest(around: Surroundings) -> float:
    """The rate that crosses the range of the input within a sample."""
    return around.ranges["input"].span / around.sample_time
