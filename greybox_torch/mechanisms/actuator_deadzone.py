"""A dead band of the input, with sharp or with round corners."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.by_direction import ByDirection, larger_forms
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.soft_limit import log_of_limited
from greybox_torch.mechanisms.transmission import dead_zone
from greybox_torch.model import Parameter, Signals

FIRST_SOFTNESS = 0.3
"""Where a round corner begins: at zero hardly anything depends on it."""


class ActuatorDeadzone(ByDirection):
    """The input acts only beyond ±``half_width``.

    ``by_direction``, with an ``asymmetry`` a, beyond (1 + a) and −(1 − a) times that. ``soft``: its corners are round, u − u / (1 +
    |u / half_width|^n)^(1/n) acts, with n = 1 / ``softness``: valves leak before they open, and amplifiers cross over by and by.
    """

    name = "actuator_deadzone"
    kinds = ("actuator",)
    needs = ("input",)
    essential = ("half_width",)
    nature = "an input that acts in part only"
    explanation = "Small inputs do nothing (valve overlap, amplifier dead band)."
    source = "G. Tao, P. V. Kokotović, Adaptive Control of Systems with Actuator and Sensor Nonlinearities, 1996"
    experiment = "small inputs around zero"

    def __init__(self, by_direction: bool = False, soft: bool = False) -> None:
        super().__init__(by_direction)
        self.soft = soft

    def described_here(self) -> str:
        if self.soft:
            by_direction = "; w is (1 + asymmetry) half_width above zero and (1 − asymmetry) half_width below"
            w, told = ("w", by_direction) if self.by_direction else ("half_width", "")
            return f"A part 1 − (1 + |u / {w}|^n)^(−1/n) of the input u acts, n = 1 / softness{told}"
        ends = "above (1 + asymmetry) half_width and below −(1 − asymmetry) half_width"
        return f"The input acts only {ends if self.by_direction else 'beyond ±half_width'}"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach = around.ranges["input"].reach
        lower = 0.01 * reach if self.soft else 0.0
        width = Parameter(
            "half_width", lower, around.force_unit, lower=lower, upper=0.9 * reach, description="half the dead band"
        )
        softness = Parameter(
            "softness", FIRST_SOFTNESS, "", lower=0.0, upper=1.0, description="0: sharp corners, 0.5: gradual"
        )
        return [width, *self.asymmetry("the dead band's ends"), *([softness] if self.soft else [])]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        more = p.asymmetry if self.by_direction else 0.0
        if self.soft:
            width = p.half_width * (1 + more * torch.sign(s.input))
            return -s.input * torch.exp(log_of_limited(s.input / width, p.softness))
        return dead_zone(s.input, p.half_width * (1 - more), p.half_width * (1 + more)) - s.input

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        rms = around.ranges["input"].rms
        round_too = {"softness": FIRST_SOFTNESS} if self.soft else {}
        wide = [Probe((SHARE,), {"half_width": f * rms, **round_too}) for f in (0.2, 0.6)]
        return wide if self.soft else [Probe(("half_width",)), *wide]

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With ends that differ by direction, with round corners, and with both."""
        begun, further = {"asymmetry": 0.0, "softness": FIRST_SOFTNESS}, larger_forms((self.by_direction, self.soft))
        return [
            (ActuatorDeadzone(*f), {**{n: begun[n] for n, has in zip(begun, f, strict=True) if has}, **values})
            for f in further
        ]

    def plainer(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        """With the same width on both sides, or else with sharp corners."""
        if self.by_direction or not self.soft:
            return super().plainer(values)
        return ActuatorDeadzone(), {n: v for n, v in values.items() if n != "softness"}
