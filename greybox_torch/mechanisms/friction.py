"""Friction on a body that depends on its speed alone: viscous, Coulomb, drag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.bristles import bending, bristle, shortest_bristles
from greybox_torch.mechanisms.forces import BIAS_OR_ASYMMETRY, ConstantBias
from greybox_torch.mechanisms.linear_law import LinearLaw, Per
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.sign_change import DryLaw, smooth_sign
from greybox_torch.model import Parameter, Signals, State


class ViscousFriction(LinearLaw):
    """−c v."""

    name = "viscous_friction"
    kinds = ("body",)
    needs = ("speed",)
    rubs = True
    nature = "friction that grows with speed"
    explanation = "A force proportional to speed opposes the motion (lubricant, back-EMF, air at low speed)."
    source = "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30(7), 1994"
    experiment = "several constant speeds in each direction"
    parameter, measured_in, lower, description = "c", Per("speed"), 0.0, "viscous coefficient"

    def law(self, s: Signals, size: Any) -> Any:
        return -size * s.speed


class CoulombFriction(DryLaw):
    """−F_c tanh(v / v_0).

    ``sticking``, −F_c z / z_0 with dz/dt = v − |v| z / z_0, bristles so short (z_0 is fixed) that they only make it stick: pushed with less
    than F_c a body stays where it is, for as long as it is pushed, where tanh lets it creep.
    """

    name = "coulomb_friction"
    kinds = ("body",)
    needs = ("speed",)
    rubs = True
    nature = "dry friction"
    explanation = "A constant force opposes the motion, whatever its speed (dry friction)."
    source = "C. A. Coulomb, 1785; B. Armstrong-Hélouvry et al., Automatica 30(7), 1994"
    experiment = "slow reversals at constant speed"
    parameter, measured_in, lower, description = "F_c", Per(), 0.0, "Coulomb level"

    def __init__(self, sticking: bool = False) -> None:
        self.sticking = sticking

    def described_here(self) -> str:
        return "−F_c sign(v), with sticking" if self.sticking else self.described()

    def change_of_sign(self, around: Surroundings) -> Parameter:
        return shortest_bristles(around) if self.sticking else super().change_of_sign(around)

    def states(self, around: Surroundings) -> list[State]:
        return [bristle(around)] if self.sticking else []

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        return {"bristle": bending(s.speed, z.bristle, p.z_0, s.sample_time)} if self.sticking else {}

    def law(self, s: Signals, size: Any) -> Any:
        return -size

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.F_c * z.bristle / p.z_0 if self.sticking else super().force(s, p, z)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((self.parameter,))] if self.sticking else super().probes(around)

    def begun_elsewhere(self, around: Surroundings, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        return () if self.sticking else super().begun_elsewhere(around, values)

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        return () if self.sticking else ((CoulombAsymmetry(with_level=True), {**values, "delta": 0.0}),)


LEAST_ASYMMETRY = 0.05
"""Share of the mean level from which half the difference of two levels is worth a law: what dry friction lacks else is no less."""


class CoulombAsymmetry(DryLaw):
    """−ΔF |tanh(v / v_0)|: the Coulomb level is larger in one direction by 2 ΔF; ``with_level``, −F_c tanh(v / v_0) besides.

    Both levels change their sign over the same width. The latter is for a body whose model has no dry friction: its levels are F_c + ΔF
    and F_c − ΔF, neither of which can push.
    """

    name = "coulomb_asymmetry"
    kinds = ("body",)
    needs = ("speed",)
    generalises = ("constant_bias",)
    nature = "dry friction"
    explanation = (
        "The Coulomb level differs between the two directions of motion (preloaded bearings, seals, gear flanks)."
    )
    source = "A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, 2019"
    experiment = BIAS_OR_ASYMMETRY
    parameter, measured_in, description = "delta", Per(), "half the difference of the levels"

    def __init__(self, with_level: bool = False) -> None:
        self.with_level = with_level
        if with_level:
            self.generalises = self.includes = ("coulomb_friction", "constant_bias")
            self.stands_for = ("constant_bias", "coulomb_asymmetry")
            self.rubs = True

    def beside(self, around: Surroundings) -> list[Parameter]:
        level = Parameter("F_c", 0.0, around.force_unit, lower=0.0, description="mean Coulomb level")
        return [level] if self.with_level else []

    def law(self, s: Signals, size: Any) -> Any:
        return -size

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        sign = smooth_sign(s.speed, p.v_0)
        uneven = self.law(s, p.delta) * torch.abs(sign)
        return uneven - p.F_c * sign if self.with_level else uneven

    def as_two(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """Coulomb friction and a constant force, which pushes at rest."""
        level = {n: values[n] for n in ("F_c", "v_0")} if self.with_level else {}
        return ((CoulombFriction(), level), (ConstantBias(), {"bias": -values["delta"]})) if level else ()

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        half, level, unit = abs(values["delta"]), values.get("F_c", 0.0), around.force_unit
        if not self.with_level or LEAST_ASYMMETRY * level <= half <= level:
            return None
        told = f"delta = {values['delta']:.3g} {unit} is"
        if half > level:
            return f"{told} more than F_c = {level:.3g} {unit}: friction would push"
        return f"{told} less than {LEAST_ASYMMETRY:g} of F_c = {level:.3g} {unit}: the two levels hardly differ"


class QuadraticDrag(LinearLaw):
    """−c v |v|."""

    name = "quadratic_drag"
    kinds = ("body",)
    needs = ("speed",)
    rubs = True
    nature = "friction that grows with speed"
    explanation = "A force growing with the square of speed opposes the motion (air or oil churning)."
    source = "B. Armstrong-Hélouvry et al., Automatica 30(7), 1994"
    experiment = "constant speeds up to the highest"
    parameter, measured_in, lower, description = "c", Per("speed", 2), 0.0, "drag coefficient"

    def law(self, s: Signals, size: Any) -> Any:
        return -size * s.speed * torch.abs(s.speed)
