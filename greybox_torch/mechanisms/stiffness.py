"""Couplings between two masses: springs that are not linear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals

SIDES = ("up", "down")
"""Ends of the names of what is on either side of rest, where the deflection is positive and where it is negative."""


class NonlinearStiffness(Mechanism):
    """k_2 δ |δ| + k_3 δ³ + k_a δ² + F_0 tanh(δ / δ_0): stiffening or softening polynomials, and a spring that is stiff at first.

    With ``k_a`` the spring is stiffer in one direction than in the other (a cone, a preloaded joint, a membrane). ``stops``: a spring that
    runs into rubber on either side, a p + b p² with p what the deflection is beyond where the rubber begins.
    """

    name = "nonlinear_stiffness"
    kinds = ("coupling",)
    needs = ("deflection",)
    natural = ("d_0", "from_up.upper", "from_down.upper")
    later = ("k_a",)
    springs = True
    nature = "a coupling that is no linear spring"
    explanation = "The spring stiffens or softens with deflection."
    source = (
        "T. Tuttle, W. Seering, IEEE Trans. Robotics and Automation 12(3), 1996 (harmonic drives); J. C. Dixon, The Shock Absorber "
        "Handbook, 2007 (bump and rebound stops)"
    )
    experiment = "static loads up to the largest"

    def __init__(self, stops: bool = False) -> None:
        self.stops = stops

    def parameters(self, around: Surroundings) -> list[Parameter]:
        if self.stops:
            return [p for side in SIDES for p in _of_a_stop(side, around)]
        reach, unit = around.ranges["deflection"].reach, around.units.get("deflection", "")
        return [
            Parameter("k_2", 0.0, around.per("deflection", 2), description="coefficient of δ|δ|"),
            Parameter("k_3", 0.0, around.per("deflection", 3), description="coefficient of δ³"),
            Parameter("k_a", 0.0, around.per("deflection", 2), description="coefficient of δ², between the directions"),
            Parameter("F_0", 0.0, around.force_unit, lower=0.0, description="level of the part that is stiff at first"),
            Parameter(
                "d_0", 0.2 * reach, unit, lower=0.01 * reach, upper=reach, description="deflection where it gives way"
            ),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        if self.stops:
            beyond = {"up": s.deflection - p.from_up, "down": -s.deflection - p.from_down}
            up, down = (_rubber(torch.clamp(beyond[e], min=0.0), p[f"a_{e}"], p[f"b_{e}"]) for e in SIDES)
            return up - down
        odd = p.k_2 * s.deflection * torch.abs(s.deflection) + p.k_3 * s.deflection**3
        return odd + p.k_a * s.deflection**2 + p.F_0 * torch.tanh(s.deflection / p.d_0)

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """As rubber stops, which no polynomial follows."""
        return () if self.stops else ((NonlinearStiffness(stops=True), {}),)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        reach = around.ranges["deflection"].reach
        if self.stops:
            directions = tuple(f"{name}_{side}" for side in SIDES for name in "ab")
            return [Probe(directions, {f"from_{side}": share * reach for side in SIDES}) for share in (0.2, 0.5)]
        softening = (Probe(("F_0",), {"d_0": f * reach}) for f in (0.03, 0.1, 0.3))
        return [
            *(Probe(names, {"d_0": 0.2 * reach}) for names in (("k_3",), ("k_2", "k_3"), ("k_3", "k_a"))),
            *softening,
        ]


def _of_a_stop(side: str, around: Surroundings) -> list[Parameter]:
    reach, unit = around.ranges["deflection"].reach, around.units.get("deflection", "")
    return [
        Parameter(
            f"from_{side}", 0.4 * reach, unit, lower=0.0, upper=reach, description="deflection where rubber begins"
        ),
        Parameter(f"a_{side}", 0.0, around.per("deflection"), lower=0.0, description="its stiffness at first"),
        Parameter(f"b_{side}", 0.0, around.per("deflection", 2), lower=0.0, description="by which that grows"),
    ]


def _rubber(pressed: Any, a: Any, b: Any) -> Any:
    return a * pressed + b * pressed**2
