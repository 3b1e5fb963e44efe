"""Friction on a body with a memory: bristles that bend before they slip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.bristles import SHORTEST, bending, bristle, shortest_followed
from greybox_torch.mechanisms.degenerate import faster_than_it_went, longer_than_the_travel
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals, State


class PreslidingHysteresis(Mechanism):
    """−F z / z_0 with dz/dt = v − |v| z / z_0 (Dahl).

    ``sharp``, slip sets in at once: with r = z / z_0, dz/dt = v − |v| r (1 − m + m |r|⁷), m from 0 to 1 (Dupont's elasto-plastic element
    as m goes to 1), and bristles damp by −σ dz/dt. ``falling``, the level falls with speed (LuGre): z_0 (1 + s exp(−(v / v_s)²)) takes
    the place of the z_0 at which bristles slip, and F (1 + s) is the level near standstill. At speeds at which they slip within less than
    a sample, bristles bend and slip as fast as steps of a sample can follow: slow motion shows z_0, fast motion the level alone.
    """

    name = "presliding_hysteresis"
    kinds = ("body",)
    needs = ("speed",)
    generalises = ("coulomb_friction",)
    includes = generalises
    natural = ("z_0.lower", "sharpness")
    rubs = True
    nature = "dry friction"
    explanation = "Before sliding, friction acts like a spring that yields (bristles bend, then slip)."
    source = (
        "P. R. Dahl, Aerospace Corp. TOR-0158, 1968; C. Canudas de Wit et al., IEEE TAC 40(3), 1995; "
        "P. Dupont et al., IEEE TAC 47(5), 2002"
    )
    experiment = "tiny reversals around standstill"

    def __init__(self, sharp: bool = False, falling: bool = False) -> None:
        self.sharp, self.falling = sharp, falling

    def parameters(self, around: Surroundings) -> list[Parameter]:
        least, reach = shortest_followed(around), around.ranges["speed"].reach
        speed = around.units.get("speed", "")
        found = [
            Parameter("F", 0.0, around.force_unit, lower=0.0, description="level at full sliding"),
            Parameter(
                "z_0",
                4 * least,
                speed.replace("/s", ""),
                lower=SHORTEST * least,
                upper=1e3 * least,
                description="deflection at which it slips",
            ),
        ]
        if self.sharp:
            found += [
                Parameter("sharpness", 0.0, "", lower=0.0, upper=1.0, description="how suddenly slip sets in"),
                Parameter("sigma", 0.0, around.per("speed"), lower=0.0, description="damping of the bristles"),
            ]
        if self.falling:
            found += [
                Parameter("s", 0.0, "", lower=0.0, upper=5.0, description="level at standstill above that at speed"),
                Parameter(
                    "v_s", 0.03 * reach, speed, lower=1e-3 * reach, upper=reach, description="speed over which it falls"
                ),
            ]
        return found

    def states(self, around: Surroundings) -> list[State]:
        return [bristle(around)]

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        yields_at = p.z_0 * (1.0 + p.s * torch.exp(-((s.speed / p.v_s) ** 2))) if self.falling else p.z_0
        return {"bristle": bending(s.speed, z.bristle, yields_at, s.sample_time, p.sharpness if self.sharp else None)}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        bent = -p.F * z.bristle / p.z_0
        return bent - p.sigma * self.rates(s, p, z)["bristle"] if self.sharp else bent

    def begun_as(self, contained: str, values: Mapping[str, float]) -> Mapping[str, float]:
        return {"F": values["F_c"]} if contained == "coulomb_friction" else {}

    def limit(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        """Coulomb friction that sticks: bristles too short to be seen."""
        return CoulombFriction(sticking=True), {"F_c": values["F"]}

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With slip that sets in at once, with a level that falls with speed, and with both."""
        forms = ((True, False), (False, True), (True, True))
        further = [f for f in forms if f != (self.sharp, self.falling) and f[0] >= self.sharp and f[1] >= self.falling]
        return [(PreslidingHysteresis(*form), {**_begun(*form), **values}) for form in further]

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("F",), {"z_0": factor * shortest_followed(around)}) for factor in (2, 8, 32)]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        too_fast = faster_than_it_went("v_s", values["v_s"], around) if self.falling else None
        return too_fast or longer_than_the_travel("z_0", values["z_0"], around, "position")


def _begun(sharp: bool, falling: bool) -> dict[str, float]:
    """Where the further parameters of a form begin: off their bounds, at which some have no effect."""
    return ({"sharpness": 0.5} if sharp else {}) | ({"s": 0.3} if falling else {})
