"""Friction on a body that is highest near standstill and falls with speed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.degenerate import faster_than_it_went
from greybox_torch.mechanisms.friction import CoulombFriction, ViscousFriction
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.sign_change import smooth_sign, width_parameter, widths
from greybox_torch.model import Parameter, Signals

WIDEST_BESIDE_A_PEAK = 0.2
"""Share of the Stribeck speed within which the force changes its sign. Of machines whose friction is known it was 0.08 at the most, of an
eddy current brake 0.37."""

NO_WIDTH = 0.02
"""Share of the fastest speed within which a change of sign is as good as sticking, whatever the Stribeck speed. The bristles of a guideway
gave 0.013, eddy current brakes 0.05 and 0.13."""


class StribeckFriction(Mechanism):
    """−(F_c + F_s exp(−(v / v_s)²)) tanh(v / v_0) − c v."""

    name = "stribeck_friction"
    kinds = ("body",)
    needs = ("speed",)
    generalises = ("coulomb_friction", "viscous_friction")
    includes = generalises
    essential = ("F_s",)
    natural = ("v_0",)
    rubs = True
    nature = "dry friction"
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
            width_parameter(around, 0.01),
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
            if width <= WIDEST_BESIDE_A_PEAK * share * reach
        ]

    def begun_as(self, contained: str, values: Mapping[str, float]) -> Mapping[str, float]:
        return {**values, "F_s": 0.0} if contained == CoulombFriction.name else {}

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """Bristles that slip at the same levels: what they bend before looks like a slow change of sign."""
        level, peak = values["F_c"], values["F_s"]
        if level <= 0.0:
            return ()
        bristles, begun = PreslidingHysteresis(falling=True), {"F": level, "s": peak / level, "v_s": values["v_s"]}
        return [(bristles, begun), *bristles.richer(begun)]

    def as_two(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """Dry and viscous friction, where it falls at no speed: then the two may do as well, and each may be something else."""
        if _falls(values, 0.0, math.inf):
            return ()
        level = {"F_c": values["F_c"] + values["F_s"], "v_0": values["v_0"]}
        return ((CoulombFriction(), level), (ViscousFriction(), {"c": values["c"]}))

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return faster_than_it_went("v_s", values["v_s"], around) or _highest_at_a_speed(values, around)

    def degenerate(
        self, around: Surroundings, values: Mapping[str, float], deviations: Mapping[str, float]
    ) -> str | None:
        """Of final values, which have deviations, also that the fall was not recorded; before, two laws are tried in its place."""
        return super().degenerate(around, values, deviations) or (
            _not_seen_to_fall(values, around) if deviations else None
        )


def _highest_at_a_speed(values: Mapping[str, float], around: Surroundings) -> str | None:
    """The force changes its sign so slowly that it is highest at a speed, as an eddy current brake's, and not near standstill."""
    least = NO_WIDTH * around.ranges["speed"].reach
    if values["v_0"] <= max(WIDEST_BESIDE_A_PEAK * values["v_s"], least):
        return None
    unit = around.units.get("speed", "")
    return (
        f"v_0 = {values['v_0']:.3g} {unit} is more than {WIDEST_BESIDE_A_PEAK:g} of v_s = {values['v_s']:.3g} {unit}: the force would be "
        "highest at a speed, not near standstill"
    )


def _falls(values: Mapping[str, float], slowest: float, fastest: float) -> bool:
    """Whether the force falls with speed at some of the speeds in between, the change of sign left aside."""
    steepest = min(max(values["v_s"] / math.sqrt(2.0), slowest), fastest)
    share = steepest / values["v_s"]
    return values["c"] < 2.0 * values["F_s"] * share * math.exp(-(share**2)) / values["v_s"]


def _not_seen_to_fall(values: Mapping[str, float], around: Surroundings) -> str | None:
    """No recorded speed is near standstill, and over those that are the friction only grows: a bent line, and no Stribeck effect.

    Seen: a propeller between 95 and 640 rad/s whose motor constant was 4 % off, told as Stribeck friction (0.97).
    """
    speeds = around.ranges["speed"]
    slowest = max(speeds.low, -speeds.high)
    if slowest <= NO_WIDTH * speeds.reach or _falls(values, slowest, speeds.reach):
        return None
    unit = around.units.get("speed", "")
    return f"above {slowest:.3g} {unit}, the slowest that was recorded, the friction only grows with speed"
