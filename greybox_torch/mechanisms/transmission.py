"""Couplings between two masses: play, nonlinear springs and dampers, hysteresis, kinematic error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals, State


def dead_zone(value: Any, half_gap: Any) -> Any:
    """Zero within ±half_gap, shifted towards zero by it outside."""
    return value - torch.clamp(value, -half_gap, half_gap)


class Backlash(Mechanism):
    """The spring sees the deflection less a dead zone."""

    name = "backlash"
    kinds = ("coupling",)
    needs = ("deflection",)
    kinematic = True
    explanation = "There is play: within a gap the coupling transmits nothing."
    source = "M. Nordin, P.-O. Gutman, Automatica 38(10), 2002"
    experiment = "reversals at low torque, so that the gap is crossed slowly"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach = around.ranges["deflection"].reach
        unit = around.units.get("deflection", "")
        return [Parameter("half_gap", 0.0, unit, lower=0.0, upper=reach, description="half the gap")]

    def deflection(self, s: Signals, p: Signals) -> Any:
        return dead_zone(s.deflection, p.half_gap)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        reach = around.ranges["deflection"].reach
        return [Probe(("half_gap",)), *(Probe((SHARE,), {"half_gap": f * reach}) for f in (0.03, 0.1, 0.3))]


class NonlinearStiffness(Mechanism):
    """k_2 δ |δ| + k_3 δ³ + F_0 tanh(δ / δ_0): stiffening or softening polynomials, and a spring that is stiff at first."""

    name = "nonlinear_stiffness"
    kinds = ("coupling",)
    needs = ("deflection",)
    explanation = "The spring stiffens or softens with deflection."
    source = "T. Tuttle, W. Seering, IEEE Trans. Robotics and Automation 12(3), 1996 (harmonic drives)"
    experiment = "static loads up to the largest"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach, unit = around.ranges["deflection"].reach, around.units.get("deflection", "")
        return [
            Parameter("k_2", 0.0, around.per("deflection", 2), description="coefficient of δ|δ|"),
            Parameter("k_3", 0.0, around.per("deflection", 3), description="coefficient of δ³"),
            Parameter("F_0", 0.0, around.force_unit, lower=0.0, description="level of the part that is stiff at first"),
            Parameter(
                "d_0", 0.2 * reach, unit, lower=0.01 * reach, upper=reach, description="deflection where it gives way"
            ),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        polynomial = p.k_2 * s.deflection * torch.abs(s.deflection) + p.k_3 * s.deflection**3
        return polynomial + p.F_0 * torch.tanh(s.deflection / p.d_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        reach = around.ranges["deflection"].reach
        softening = (Probe(("F_0",), {"d_0": f * reach}) for f in (0.03, 0.1, 0.3))
        return [*(Probe(names, {"d_0": 0.2 * reach}) for names in (("k_3",), ("k_2", "k_3"))), *softening]


class HystereticSpring(Mechanism):
    """F r with r = z / z_0 and dz/dt = δ' − |δ'| r (1 − m + m |r|), an elasto-slip element in parallel with the spring.

    ``sharpness`` m leads from the exponent 1 of Bouc and Wen (0), where slip sets in gradually, to their exponent 2 (1).
    """

    name = "hysteretic_spring"
    kinds = ("coupling",)
    needs = ("rate",)
    explanation = "The coupling remembers: loading and unloading follow different curves (micro-slip, rubber)."
    source = "R. Bouc, 1967; Y.-K. Wen, J. Eng. Mech. 102(2), 1976; M. Ruderman, F. Hoffmann, T. Bertram, IEEE TIE 56(10), 2009"
    experiment = "slow loading and unloading between several limits"

    def _smallest(self, around: Surroundings) -> float:
        return around.ranges["rate"].reach * around.sample_time

    def parameters(self, around: Surroundings) -> list[Parameter]:
        least = self._smallest(around)
        unit = around.units.get("deflection", "")
        return [
            Parameter("F", 0.0, around.force_unit, lower=0.0, description="level at full slip"),
            Parameter(
                "z_0", 4 * least, unit, lower=0.5 * least, upper=1e3 * least, description="deflection at which it slips"
            ),
            Parameter("sharpness", 0.5, "", lower=0.0, upper=1.0, description="how suddenly slip sets in"),
        ]

    def states(self, around: Surroundings) -> list[State]:
        return [State("slip", around.units.get("deflection", ""))]

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        share = z.slip / p.z_0
        return {"slip": s.rate - torch.abs(s.rate) * share * (1.0 - p.sharpness + p.sharpness * torch.abs(share))}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return p.F * z.slip / p.z_0

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("F",), {"z_0": factor * self._smallest(around), "sharpness": 0.5}) for factor in (2, 8, 32)]


class NonlinearDamping(Mechanism):
    """d_2 δ' |δ'| + d_0 tanh(δ' / r_0)."""

    name = "nonlinear_damping"
    kinds = ("coupling",)
    needs = ("rate",)
    explanation = "The coupling's damping is not proportional to the rate of deflection."
    source = "R. Dhaouadi, F. H. Ghorbel, P. S. Gandhi, IEEE Trans. Industrial Electronics 50(6), 2003"
    experiment = "vibration at several amplitudes"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach = around.ranges["rate"].reach
        unit = around.units.get("rate", "")
        return [
            Parameter("d_2", 0.0, around.per("rate", 2), description="coefficient of r|r|"),
            Parameter("d_0", 0.0, around.force_unit, description="level of the dry part"),
            Parameter("r_0", 0.1 * reach, unit, lower=0.01 * reach, upper=reach, description="width of the dry part"),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return p.d_2 * s.rate * torch.abs(s.rate) + p.d_0 * torch.tanh(s.rate / p.r_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        reach = around.ranges["rate"].reach
        return [
            Probe(("d_2",), {"r_0": 0.1 * reach}),
            *(Probe(("d_2", "d_0"), {"r_0": f * reach}) for f in (0.03, 0.15)),
        ]


class TransmissionError(Mechanism):
    """The spring sees the deflection plus e(θ) = a cos nθ + b sin nθ, with θ the position of the driving body.

    By virtual work that body feels de/dθ times the spring's force as well; ``reaction`` is the share of it that acts (an error on the
    far side of a reduction reaches the near side divided by the ratio), where the model says what load the body carries. Where the
    body's speed ω is known, the coupling's damper answers the rate of the error, with ``damping`` · e'(θ) ω.
    """

    name = "transmission_error"
    kinds = ("coupling",)
    needs = ("deflection", "position")
    kinematic = True
    explanation = "The gear's output does not follow its input exactly: a kinematic error periodic in position."
    source = "T. Tuttle, W. Seering, IEEE Trans. Robotics and Automation 12(3), 1996"
    experiment = "slow constant speed over several turns, in both directions"

    def __init__(self, order: float = 1.0) -> None:
        self.order = order

    def parameters(self, around: Surroundings) -> list[Parameter]:
        unit = around.units.get("deflection", "")
        return [
            Parameter("a", 0.0, unit, description="cosine amplitude"),
            Parameter("b", 0.0, unit, description="sine amplitude"),
            Parameter(
                "order", self.order, "", lower=0.8 * self.order, upper=1.25 * self.order, description="periods per turn"
            ),
            *(
                [
                    Parameter(
                        "damping", 0.0, around.per("rate"), lower=0.0, description="damper's answer to the error's rate"
                    )
                ]
                if "speed" in around.ranges
                else []
            ),
            *(
                [Parameter("reaction", 0.5, "", lower=0.0, upper=1.0, description="share of e'T")]
                if self._reacts(around)
                else []
            ),
        ]

    def deflection(self, s: Signals, p: Signals) -> Any:
        angle = p.order * s.position
        return s.deflection + p.a * torch.cos(angle) + p.b * torch.sin(angle)

    def reaction(self, s: Signals, p: Signals) -> Any:
        return -p.reaction * _slope(s, p) * s.load if "reaction" in p and "load" in s else None

    def damped(self, s: Signals, p: Signals) -> Any:
        return p.damping * _slope(s, p) * s.speed if "damping" in p and "speed" in s else None

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        fixed = {"order": self.order, **({"damping": 0.0} if "speed" in around.ranges else {})}
        shares: list[dict[str, float]] = [{"reaction": 0.0}, {"reaction": 1.0}] if self._reacts(around) else [{}]
        return [Probe(("a", "b"), {**fixed, **share}) for share in shares]

    def _reacts(self, around: Surroundings) -> bool:
        return "load" in around.ranges


def _slope(s: Signals, p: Signals) -> Any:
    """The slope de/dθ of a periodic error."""
    angle = p.order * s.position
    return p.order * (p.b * torch.cos(angle) - p.a * torch.sin(angle))
