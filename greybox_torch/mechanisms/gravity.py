"""Weight, on one body or on a chain of links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.degenerate import is_angle
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals


class Gravity(Mechanism):
    """−(a sin θ + b cos θ): once per turn.

    With ``links``, the bodies of a chain from its base on, each angle counted from the link before: link k stands at φ_k = θ_1 + … + θ_k,
    and joint j carries the weight of every link behind it, τ_j = −Σ_{k ≥ j} (a_k sin φ_k + b_k cos φ_k). The port is the first joint.
    """

    name = "gravity"
    kinds = ("body",)
    needs = ("position",)
    nature = "a force that depends on position"
    explanation = "Weight pulls with a torque that depends on the angle, once per turn."
    source = "W. Khalil, E. Dombre, Modeling, Identification and Control of Robots, 2002"
    experiment = "slow motion over a full turn"

    def __init__(self, links: Sequence[str] = ()) -> None:
        self.links = tuple(links)

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [
            Parameter(f"{letter}{end}", 0.0, around.force_unit, description=f"{wave} amplitude{of}")
            for end, of in self._ends()
            for letter, wave in (("a", "sine"), ("b", "cosine"))
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        if not self.links:
            return -(p.a * torch.sin(s.position) + p.b * torch.cos(s.position))
        return sum(self._torques(s, p)[1:], start=self._torques(s, p)[0])

    def elsewhere(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        result: dict[str, Any] = {}
        behind: Any = 0.0
        for link, torque in list(zip(self.links, self._torques(s, p), strict=True))[:0:-1]:
            behind = behind + torque
            result[link] = behind
        return result

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(tuple(p.name for p in self.parameters(around)))]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        if is_angle(around):
            return None
        return f"weight goes with the sine of an angle, and position is in {around.units['position']}"

    def _ends(self) -> list[tuple[str, str]]:
        """What the names and the descriptions of the amplitudes end with."""
        return [(f"_{link}", f" of {link}") for link in self.links] or [("", "")]

    def _torques(self, s: Signals, p: Signals) -> list[Any]:
        """The torque of each link's weight about every joint before it."""
        result, angle = [], 0.0
        for link in self.links:
            angle = angle + s[f"position@{link}"]
            result.append(-(p[f"a_{link}"] * torch.sin(angle) + p[f"b_{link}"] * torch.cos(angle)))
        return result
