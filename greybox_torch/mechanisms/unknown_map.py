"""A flexible map over two signals: the answer `unknown` at an actuator whose effect on a speed is no product of two curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals

KNOTS = 7
"""Bumps over either signal."""


class UnknownMap(Mechanism):
    """Σ_ij w_ij b_i(s) b_j(o), with smooth bumps b over the ranges of two signals: what acts besides an input s, also by another signal o.

    An engine's torque over its fuel and its speed, a pump's over its pressure and its speed, a propeller's. The bumps are
    exp(−((s − s_i) / w)²), with their centres spread evenly over where the signal moved, one beyond either end; beyond that the map stays
    level.
    """

    name = "unknown_map"
    kinds = ("actuator",)
    needs = ("input", "speed")
    free = True
    modes = 1
    nature = "a map over the input and the speed"
    explanation = "What acts is a map of the input and the speed (an engine, a pump, a propeller)."
    source = "radial basis functions: D. S. Broomhead, D. Lowe, Complex Systems 2, 1988"
    experiment = "steps of the input at several constant speeds"
    signal = "input"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        both = range(KNOTS)
        heights = [
            Parameter(f"w_{i}_{j}", 0.0, around.force_unit, description=f"height at bumps {i} and {j}", shrunk=True)
            for i in both
            for j in both
        ]
        return [*heights, *(p for signal in self.needs for p in _grid(signal, around))]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        over = [_bumps(s[signal], p[f"first_{signal}"], p[f"spacing_{signal}"]) for signal in self.needs]
        return sum(
            bump * sum(p[f"w_{i}_{j}"] * other for j, other in enumerate(over[1])) for i, bump in enumerate(over[0])
        )

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(tuple(f"w_{i}_{j}" for i in range(KNOTS) for j in range(KNOTS)))]


def _grid(signal: str, around: Surroundings) -> list[Parameter]:
    """Where the first bump over a signal is, and how far apart they are."""
    reached, unit = around.ranges[signal], around.units.get(signal, "")
    spacing = reached.span / (KNOTS - 3)
    return [
        Parameter(
            f"first_{signal}", reached.low - spacing, unit, fixed=True, description=f"first centre over {signal}"
        ),
        Parameter(f"spacing_{signal}", spacing, unit, fixed=True, description=f"distance of the centres over {signal}"),
    ]


def _bumps(signal: Any, first: Any, spacing: Any) -> list[Any]:
    """The bumps at a signal."""
    place = torch.clamp((signal - first) / spacing, 1.0, KNOTS - 2.0)
    return [torch.exp(-((place - k) ** 2)) for k in range(KNOTS)]
