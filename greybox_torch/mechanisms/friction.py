"""Friction on a body: forces that depend on speed, load, position or time and oppose the motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals, State


def smooth_sign(speed: Any, width: Any) -> Any:
    """tanh(v / v_0), the sign of a speed with a transition that a solver can follow."""
    return torch.tanh(speed / width)


def width_parameter(around: Surroundings) -> Parameter:
    """The speed v_0 over which a Coulomb force changes its sign."""
    reach = around.ranges["speed"].reach
    unit = around.units.get("speed", "")
    return Parameter(
        "v_0", 0.03 * reach, unit, lower=2e-3 * reach, upper=0.3 * reach, description="width of the sign change"
    )


def widths(around: Surroundings) -> list[float]:
    """Widths of the sign change that a screen looks at."""
    reach = around.ranges["speed"].reach
    return [0.005 * reach, 0.03 * reach, 0.1 * reach]


class ViscousFriction(Mechanism):
    """−c v."""

    name = "viscous_friction"
    kinds = ("body",)
    needs = ("speed",)
    explanation = "A force proportional to speed opposes the motion (lubricant, back-EMF, air at low speed)."
    source = "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30(7), 1994"
    experiment = "several constant speeds in each direction"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [Parameter("c", 0.0, around.per("speed"), lower=0.0, description="viscous coefficient")]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.c * s.speed

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("c",))]


class CoulombFriction(Mechanism):
    """−F_c tanh(v / v_0)."""

    name = "coulomb_friction"
    kinds = ("body",)
    needs = ("speed",)
    explanation = "A constant force opposes the motion, whatever its speed (dry friction)."
    source = "C. A. Coulomb, 1785; B. Armstrong-Hélouvry et al., Automatica 30(7), 1994"
    experiment = "slow reversals at constant speed"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [
            Parameter("F_c", 0.0, around.force_unit, lower=0.0, description="Coulomb level"),
            width_parameter(around),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.F_c * smooth_sign(s.speed, p.v_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("F_c",), {"v_0": width}) for width in widths(around)]


class StribeckFriction(Mechanism):
    """−(F_c + F_s exp(−(v / v_s)²)) tanh(v / v_0) − c v."""

    name = "stribeck_friction"
    generalises = ("coulomb_friction", "viscous_friction")
    includes = generalises
    kinds = ("body",)
    needs = ("speed",)
    explanation = (
        "Friction is highest near standstill and falls with speed before viscous friction takes over (Stribeck effect)."
    )
    source = "R. Stribeck, 1902; C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, IEEE TAC 40(3), 1995"
    experiment = "very slow motion in both directions, through standstill"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach = around.ranges["speed"].reach
        unit = around.units.get("speed", "")
        return [
            Parameter("F_c", 0.0, around.force_unit, lower=0.0, description="Coulomb level"),
            Parameter("F_s", 0.0, around.force_unit, lower=0.0, description="extra level near standstill"),
            Parameter("c", 0.0, around.per("speed"), lower=0.0, description="viscous coefficient"),
            Parameter("v_s", 0.1 * reach, unit, lower=0.005 * reach, upper=reach, description="Stribeck speed"),
            width_parameter(around),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        level = p.F_c + p.F_s * torch.exp(-((s.speed / p.v_s) ** 2))
        return -level * smooth_sign(s.speed, p.v_0) - p.c * s.speed

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        reach = around.ranges["speed"].reach
        return [
            Probe(("F_c", "F_s", "c"), {"v_s": share * reach, "v_0": width})
            for share in (0.05, 0.2)
            for width in widths(around)[:2]
        ]


class CoulombAsymmetry(Mechanism):
    """−ΔF |tanh(v / v_0)|: the Coulomb level is larger in one direction by 2 ΔF."""

    name = "coulomb_asymmetry"
    kinds = ("body",)
    needs = ("speed",)
    generalises = ("constant_bias",)
    explanation = (
        "The Coulomb level differs between the two directions of motion (preloaded bearings, seals, gear flanks)."
    )
    source = "A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, 2019"
    experiment = "standstill and reversals without load: a bias pushes at rest, an asymmetry does not"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [
            Parameter("delta", 0.0, around.force_unit, description="half the difference of the levels"),
            width_parameter(around),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.delta * smooth_sign(s.speed, p.v_0) ** 2

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("delta",), {"v_0": width}) for width in widths(around)]


class QuadraticDrag(Mechanism):
    """−c v |v|."""

    name = "quadratic_drag"
    kinds = ("body",)
    needs = ("speed",)
    explanation = "A force growing with the square of speed opposes the motion (air or oil churning)."
    source = "B. Armstrong-Hélouvry et al., Automatica 30(7), 1994"
    experiment = "constant speeds up to the highest"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [Parameter("c", 0.0, around.per("speed", 2), lower=0.0, description="drag coefficient")]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.c * s.speed * torch.abs(s.speed)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("c",))]


class LoadDependentFriction(Mechanism):
    """−c |load| tanh(v / v_0)."""

    name = "load_dependent_friction"
    kinds = ("body",)
    needs = ("speed", "load")
    explanation = "Friction grows with the load carried (gear meshes, bearings under force)."
    source = "P. Hamon, M. Gautier, P. Garrec, IEEE/RSJ IROS, 2010; A. C. Bittencourt, S. Gunnarsson, J. Dyn. Sys. Meas. Control 134, 2012"
    experiment = "the same speeds under different loads"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [Parameter("c", 0.0, "", lower=0.0, upper=2.0, description="friction per load"), width_parameter(around)]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.c * torch.abs(s.load) * smooth_sign(s.speed, p.v_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("c",), {"v_0": width}) for width in widths(around)]


class FrictionWarmup(Mechanism):
    """−ΔF exp(−t / T) tanh(v / v_0): Coulomb friction that decays (ΔF > 0) or grows with time."""

    name = "friction_warmup"
    kinds = ("body",)
    needs = ("speed", "time")
    explanation = "The friction level drifts as the machine warms up."
    source = "A. C. Bittencourt, S. Gunnarsson, J. Dyn. Sys. Meas. Control 134, 2012"
    experiment = "the same motion repeated from cold to warm"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        total = max(around.ranges["time"].high, around.sample_time)
        return [
            Parameter("delta", 0.0, around.force_unit, description="level at the start above the final one"),
            Parameter("T", 0.3 * total, "s", lower=0.02 * total, upper=5 * total, description="time constant"),
            width_parameter(around),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.delta * torch.exp(-s.time / p.T) * smooth_sign(s.speed, p.v_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        total = max(around.ranges["time"].high, around.sample_time)
        return [
            Probe(("delta",), {"T": share * total, "v_0": width})
            for share in (0.1, 0.3, 1.0)
            for width in widths(around)[:2]
        ]


class PreslidingHysteresis(Mechanism):
    """−F z / z_0 with dz/dt = v − |v| z / z_0 (Dahl)."""

    name = "presliding_hysteresis"
    generalises = ("coulomb_friction",)
    includes = generalises
    kinds = ("body",)
    needs = ("speed",)
    explanation = "Before sliding, friction acts like a spring that yields (bristles bend, then slip)."
    source = "P. R. Dahl, Aerospace Corp. TOR-0158, 1968; C. Canudas de Wit et al., IEEE TAC 40(3), 1995"
    experiment = "tiny reversals around standstill"

    def _smallest(self, around: Surroundings) -> float:
        """A bristle deflection whose time constant the sampling still resolves."""
        return around.ranges["speed"].reach * around.sample_time

    def parameters(self, around: Surroundings) -> list[Parameter]:
        least = self._smallest(around)
        unit = around.units.get("speed", "").replace("/s", "")
        return [
            Parameter("F", 0.0, around.force_unit, lower=0.0, description="level at full sliding"),
            Parameter(
                "z_0", 4 * least, unit, lower=0.5 * least, upper=1e3 * least, description="deflection at which it slips"
            ),
        ]

    def states(self, around: Surroundings) -> list[State]:
        return [State("bristle", around.units.get("speed", "").replace("/s", ""))]

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        return {"bristle": s.speed - torch.abs(s.speed) * z.bristle / p.z_0}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.F * z.bristle / p.z_0

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("F",), {"z_0": factor * self._smallest(around)}) for factor in (2, 8, 32)]


class PositionDependentFriction(Mechanism):
    """−(a cos nθ + b sin nθ) tanh(v / v_0)."""

    name = "position_dependent_friction"
    generalises = ("coulomb_friction",)
    kinds = ("body",)
    needs = ("speed", "position")
    explanation = "The friction level varies periodically with position (bent shaft, eccentric bearing)."
    source = "M. R. Popović, A. A. Goldenberg, IEEE Trans. Robotics and Automation 14(1), 1998"
    experiment = "the same positions passed in both directions"

    def __init__(self, order: float = 1.0) -> None:
        self.order = order

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [
            Parameter("a", 0.0, around.force_unit, description="cosine amplitude"),
            Parameter("b", 0.0, around.force_unit, description="sine amplitude"),
            Parameter(
                "order", self.order, "", lower=0.8 * self.order, upper=1.25 * self.order, description="periods per turn"
            ),
            width_parameter(around),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        angle = p.order * s.position
        return -(p.a * torch.cos(angle) + p.b * torch.sin(angle)) * smooth_sign(s.speed, p.v_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("a", "b"), {"order": self.order, "v_0": widths(around)[1]})]
