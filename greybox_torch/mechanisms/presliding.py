"""Friction on a body with a memory: bristles that bend before they slip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.degenerate import longer_than_the_travel
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.slip import slip_share
from greybox_torch.model import Parameter, Signals, State


class PreslidingHysteresis(Mechanism):
    """−F z / z_0 with dz/dt = v − |v| z / z_0 (Dahl)."""

    name = "presliding_hysteresis"
    kinds = ("body",)
    needs = ("speed",)
    generalises = ("coulomb_friction",)
    includes = generalises
    natural = ("z_0.lower",)
    rubs = True
    nature = "dry friction"
    explanation = "Before sliding, friction acts like a spring that yields (bristles bend, then slip)."
    source = "P. R. Dahl, Aerospace Corp. TOR-0158, 1968; C. Canudas de Wit et al., IEEE TAC 40(3), 1995"
    experiment = "tiny reversals around standstill"

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
        return {"bristle": s.speed - torch.abs(s.speed) * slip_share(z.bristle, p.z_0)}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.F * z.bristle / p.z_0

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("F",), {"z_0": factor * self._smallest(around)}) for factor in (2, 8, 32)]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return longer_than_the_travel("z_0", values["z_0"], around, "position")

    def _smallest(self, around: Surroundings) -> float:
        """A bristle deflection whose time constant the sampling still resolves."""
        return around.ranges["speed"].reach * around.sample_time
