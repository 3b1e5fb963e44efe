"""What changes as it is used and comes back at rest: the answer `unknown` where a force depends on how much went on before."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.degenerate import not_a_time_of_the_record
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals, State

SHORTEST_SOUGHT, TIMES = 10.0, 6
"""Samples of the shortest time constant that is looked for, and how many are, up to the length of the longest record."""


class UnknownFading(Mechanism):
    """change z s: a gain on the local signal s that changes with a memory z of it, T dz/dt = |σ|ⁿ (1 − q z) − z, σ = s / reach.

    A battery that sags under load and recovers, a torque constant of a winding that heats up, a paste that thins as it is stirred, rubber
    that softens. What z begins with is estimated for every experiment; ``reach`` is the largest |s| that was recorded. The power n is 2
    (heat) or 1 (shear).
    With q above zero it is used up faster than it comes back, by 1 + q times where |s| stays at ``reach``.
    """

    name = "unknown_fading"
    kinds = ("body", "coupling", "balance", "actuator")
    free = True
    essential = ("change",)
    natural = ("q",)
    lasting = ("used",)
    modes = 1
    nature = "a gain that fades as it is used"
    explanation = "A gain changes as the signal is used, and comes back at rest (a battery, a winding that heats up, a paste that thins)."
    source = "M. Chen, G. Rincón-Mora, Accurate electrical battery model, IEEE Trans. Energy Conversion 21, 2006"
    experiment = "the same motion again and again after a rest, and once more after another rest"

    def __init__(self, signal: str, power: int = 2) -> None:
        self.signal = signal
        self.power = power

    def parameters(self, around: Surroundings) -> list[Parameter]:
        unit, step = around.units.get(self.signal, ""), around.sample_time
        gain = "" if self.signal == "input" else around.per(self.signal)
        return [
            Parameter("change", 0.0, gain, description="change of the gain where z is one"),
            Parameter(
                "T", 100 * step, "s", lower=2 * step, upper=1e5 * step, description="time in which it comes back"
            ),
            Parameter("q", 0.0, "", lower=0.0, upper=100.0, description="how much faster it is used up"),
            Parameter(
                "reach", around.ranges[self.signal].reach, unit, fixed=True, description="largest recorded signal"
            ),
        ]

    def states(self, around: Surroundings) -> list[State]:
        return [State("used", "")]

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        share = s[self.signal] / p.reach
        use = share**2 if self.power == 2 else torch.abs(share)
        return {"used": (use * (1.0 - p.q * z.used) - z.used) / p.T}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return p.change * z.used * s[self.signal]

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        shortest = SHORTEST_SOUGHT * around.sample_time
        longest = around.ranges["time"].span if "time" in around.ranges else 0.0
        times = np.geomspace(shortest, max(longest, 2 * shortest), TIMES)
        return [Probe(("change",), {"T": float(T), "q": 0.0}) for T in times]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return not_a_time_of_the_record("T", values["T"], around)

    def signals(self) -> tuple[str, ...]:
        return (self.signal,)

    def settled(self, signal: np.ndarray, values: Mapping[str, float]) -> np.ndarray:
        """The force (N,) where the signal (N,) has been what it is for long."""
        use = np.abs(signal / values["reach"]) ** self.power
        return values["change"] * use / (1.0 + values["q"] * use) * signal
