"""Couplings between two masses: play, nonlinear dampers, hysteresis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.degenerate import longer_than_the_travel
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.slip import slip_share
from greybox_torch.model import Parameter, Signals, State

HIDDEN_GAP = 30.0
"""How many times as wide as the model without it deflects half a gap may be where nobody measures the deflection: that model damps what the
machine plays.
"""

ROUNDING = 1e-9
"""Share of a gap that is nothing."""


def dead_zone(value: Any, below: Any, above: Any) -> Any:
    """Zero from −below to above, shifted towards zero by them outside."""
    return value - torch.clamp(value, -below, above)


class Backlash(Mechanism):
    """The spring sees the deflection less a dead zone.

    Where sensors show the deflection, the gap has a ``centre``: those at either end have zeros of their own, and play is seldom where they
    agree.
    Where the coupling's rate is known, its damper may lose ``damping`` within the gap, where the two sides do not touch: a part of its
    coefficient, or all of it. ``as_force``: the same as a force, with the ``stiffness`` of the spring as a parameter of its own, for
    a model in which no state reaches this spring alone. ``stiffening``: what touches beyond the gap grows stiffer, by k_2 p |p| of
    force with p what the deflection is beyond it, as teeth and cables do.
    """

    name = "backlash"
    kinds = ("coupling",)
    needs = ("deflection",)
    later = ("damping", "centre")
    springs = True
    nature = "a coupling that is no linear spring"
    explanation = "There is play: within a gap the coupling transmits nothing."
    source = "M. Nordin, P.-O. Gutman, Automatica 38(10), 2002"
    experiment = "reversals at low torque, so that the gap is crossed slowly"

    def __init__(self, as_force: bool = False, stiffening: bool = False) -> None:
        self.as_force, self.stiffening = as_force, stiffening
        self.kinematic = not as_force

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach, unit = around.ranges["deflection"].reach, around.units.get("deflection", "")
        wide = 0.1 * reach if self.as_force else 0.0
        found = [Parameter("half_gap", wide, unit, lower=0.0, upper=self.widest(around), description="half the gap")]
        if self.as_force:
            stiffness = "stiffness of the coupling's spring"
            found.append(Parameter("stiffness", 0.0, around.per("deflection"), lower=0.0, description=stiffness))
        if "deflection" not in around.unmeasured:
            found.append(Parameter("centre", 0.0, unit, lower=-reach, upper=reach, description="middle of the gap"))
        if "rate" in around.ranges:
            lost = "what the coupling's damper loses within the gap"
            found.append(Parameter("damping", 0.0, around.per("rate"), lower=0.0, description=lost))
        if self.stiffening:
            grows = "coefficient of p|p|, with p the deflection beyond the gap"
            found.append(Parameter("k_2", 0.0, around.per("deflection", 2), lower=0.0, description=grows))
        return found

    def widest(self, around: Surroundings) -> float:
        """The most that half the gap may be."""
        reach = around.ranges["deflection"].reach
        return HIDDEN_GAP * reach if "deflection" in around.unmeasured else reach

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        lost, beside = -p.stiffness * torch.clamp(s.deflection, *self.gap(p)), self.force_beside(s, p)
        return lost if beside is None else lost + beside

    def deflection(self, s: Signals, p: Signals) -> Any:
        low, high = self.gap(p)
        return dead_zone(s.deflection, -low, high)

    def loaded(self, deflection: np.ndarray, p: Mapping[str, float]) -> np.ndarray:
        """Beyond the gap on the side of the load."""
        return deflection + p["half_gap"] * np.sign(deflection) + p.get("centre", 0.0)

    def begun_elsewhere(self, around: Surroundings, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        """With a narrower and with a wider gap: windows that begin within it or beyond give the error a valley each."""
        gaps = (0.8 * values["half_gap"], 1.25 * values["half_gap"])
        return [{"half_gap": gap} for gap in gaps if 0.0 < gap < self.widest(around)]

    def gap(self, p: Signals) -> tuple[Any, Any]:
        """Where the gap begins and ends."""
        return (p.centre - p.half_gap, p.centre + p.half_gap) if "centre" in p else (-p.half_gap, p.half_gap)

    def force_beside(self, s: Signals, p: Signals) -> Any:
        found = [self._damped(s, p)] if "damping" in p else []
        if self.stiffening:
            # A kinematic law sees the deflection less its dead zone.
            pressed = self.deflection(s, p) if self.as_force else s.deflection
            found.append(p.k_2 * pressed * torch.abs(pressed))
        return sum(found) if found else None

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With what touches growing stiffer."""
        return () if self.stiffening else ((Backlash(self.as_force, stiffening=True), {**values, "k_2": 0.0}),)

    def plainer(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        """With a stiffness that stays."""
        return (Backlash(self.as_force), {n: v for n, v in values.items() if n != "k_2"}) if self.stiffening else None

    def written_as_force(self) -> Mechanism:
        return Backlash(as_force=True, stiffening=self.stiffening)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        gaps = [f * around.ranges["deflection"].reach for f in (0.03, 0.1, 0.3, 0.7)]
        if self.as_force:
            amplitudes = tuple(p.name for p in self.parameters(around) if p.name not in ("half_gap", "centre"))
            return [Probe(amplitudes, {"half_gap": gap}) for gap in gaps]
        return [Probe(("half_gap",)), *(Probe((SHARE,), {"half_gap": gap}) for gap in gaps)]

    def _damped(self, s: Signals, p: Signals) -> Any:
        # Within the gap the deflection that a kinematic law sees is zero, but for rounding.
        within = p.half_gap if self.as_force else ROUNDING * p.half_gap
        from_centre = s.deflection - p.centre if self.as_force and "centre" in p else s.deflection
        return torch.where(torch.abs(from_centre) < within, -p.damping * s.rate, 0.0)


class HystereticSpring(Mechanism):
    """F r with r = z / z_0 and dz/dt = δ' − |δ'| r (1 − m + m |r|) with the ``sharpness`` m, an elasto-slip element beside the spring.

    ``sharpness`` m leads from the exponent 1 of Bouc and Wen (0), where slip sets in gradually, to their exponent 2 (1).
    """

    name = "hysteretic_spring"
    kinds = ("coupling",)
    needs = ("rate",)
    natural = ("sharpness", "z_0.lower")
    springs = True
    nature = "a coupling that is no linear spring"
    explanation = "The coupling remembers: loading and unloading follow different curves (micro-slip, rubber)."
    source = "R. Bouc, 1967; Y.-K. Wen, J. Eng. Mech. 102(2), 1976; M. Ruderman, F. Hoffmann, T. Bertram, IEEE TIE 56(10), 2009"
    experiment = "slow loading and unloading between several limits"

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
        share = slip_share(z.slip, p.z_0)
        return {"slip": s.rate - torch.abs(s.rate) * share * (1.0 - p.sharpness + p.sharpness * torch.abs(share))}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return p.F * z.slip / p.z_0

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("F",), {"z_0": factor * self._smallest(around), "sharpness": 0.5}) for factor in (2, 8, 32)]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return longer_than_the_travel("z_0", values["z_0"], around, "deflection")

    def _smallest(self, around: Surroundings) -> float:
        """What the deflection changes by in a sample, as usual: the peaks are those of a model without what takes up the vibration."""
        return max(around.ranges["rate"].rms, 1e-12) * around.sample_time


class NonlinearDamping(Mechanism):
    """d_a |δ'| + d_2 δ' |δ'| + d_0 tanh(δ' / r_0): a damper that differs by direction, one that grows with the rate, and a dry one.

    Beside the damper d δ' of the model, d + d_a acts while the deflection grows and d − d_a while it shrinks. ``two_levels``: what comes
    up to a level differs by direction, too, by d_b |tanh(δ' / r_0)|: the valves of a shock absorber, which open in either direction.
    """

    name = "nonlinear_damping"
    kinds = ("coupling",)
    needs = ("rate",)
    natural = ("r_0",)
    nature = "damping that is not proportional to the rate"
    explanation = (
        "The coupling's damping is not proportional to the rate of deflection, or differs between the two directions."
    )
    source = (
        "R. Dhaouadi, F. H. Ghorbel, P. S. Gandhi, IEEE Trans. Industrial Electronics 50(6), 2003; "
        "J. C. Dixon, The Shock Absorber Handbook, 2nd ed., 2007 (compression and rebound)"
    )
    experiment = "vibration at several amplitudes"

    def __init__(self, two_levels: bool = False) -> None:
        self.two_levels = two_levels

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach = around.ranges["rate"].reach
        unit, force = around.units.get("rate", ""), around.force_unit
        other = Parameter("d_b", 0.0, force, description="half the difference of that level between the directions")
        return [
            Parameter("d_a", 0.0, around.per("rate"), description="half the difference between the directions"),
            Parameter("d_2", 0.0, around.per("rate", 2), description="coefficient of r|r|"),
            Parameter("d_0", 0.0, force, description="level of the dry part"),
            *([other] if self.two_levels else []),
            Parameter("r_0", 0.1 * reach, unit, lower=0.01 * reach, upper=reach, description="width of the dry part"),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        level = torch.tanh(s.rate / p.r_0)
        dry = p.d_0 * level + p.d_b * torch.abs(level) if self.two_levels else p.d_0 * level
        return p.d_a * torch.abs(s.rate) + p.d_2 * s.rate * torch.abs(s.rate) + dry

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With levels that differ by direction."""
        return () if self.two_levels else ((NonlinearDamping(two_levels=True), {**values, "d_b": 0.0}),)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        reach = around.ranges["rate"].reach
        return [
            Probe(("d_a",), {"r_0": 0.1 * reach}),
            Probe(("d_2",), {"r_0": 0.1 * reach}),
            *(Probe(("d_2", "d_0"), {"r_0": f * reach}) for f in (0.03, 0.15)),
        ]
