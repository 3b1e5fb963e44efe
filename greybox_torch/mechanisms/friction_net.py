"""A network that is friction: a force on a body as a function of its speed, perhaps also of load, position and time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.network import Network, own_name, spoken
from greybox_torch.mechanisms.sign_change import smooth_sign, width_parameter
from greybox_torch.model import Parameter, Signals

OVERLAP = 0.8
"""Slope of a bump in units of the bumps' spacing: neighbours meet at about half their height."""


class FrictionNet(Network):
    """Friction as a network of the speed, and of other signals of the body where asked for.

    With ``dissipative`` it is −tanh(v / v_0) Σ_k out_k exp(−Σ_i (w_ik σ_i + b_ik)²) with out_k ≥ 0: whatever the weights, the force never
    has the direction of the speed, so that friction never drives. Sums of bumps with positive heights come as near as wanted to any
    level of friction that is not negative (its average over a narrow bump is such a sum). Without, it is
    −Σ_k out_k tanh(b_k + Σ_i w_ik σ_i) − offset.

    With ``odd`` the force changes its sign with the speed: bumps are placed over |v|; otherwise the part of the sum that is odd in
    v is taken. A load enters by its magnitude, which is what presses on a bearing.

    Raises:
        UserError: the speed is not among the inputs.
    """

    name = "friction_net"
    kinds = ("body",)
    explanation = "A small network of the speed stands for friction that has no name yet."
    source = "B. Armstrong-Hélouvry et al., Automatica 30(7), 1994; J. Park, I. W. Sandberg, Neural Computation 3(2), 1991 (bumps)"

    def __init__(
        self,
        inputs: Sequence[str] = ("speed",),
        units: int = 8,
        seed: int = 0,
        odd: bool = True,
        dissipative: bool = True,
    ) -> None:
        super().__init__(inputs, units, seed)
        self.odd = odd
        self.dissipative = dissipative
        if "speed" not in self.inputs:
            raise UserError(f"friction_net: inputs are {', '.join(self.inputs)}; expected the speed among them")

    def span(self, name: str, around: Surroundings) -> tuple[float, float]:
        low, high = super().span(name, around)
        if name == "load" or (name == "speed" and self.odd and self.dissipative):
            return 0.0, around.ranges[name].reach
        return (-around.ranges[name].reach, around.ranges[name].reach) if name == "speed" else (low, high)

    def parameters(self, around: Surroundings) -> list[Parameter]:
        if self.dissipative:
            return [*self.heights(around, lower=0.0), *self._bumps(), width_parameter(around), *self.scaling(around)]
        offset = Parameter("offset", 0.0, around.force_unit, description="constant", shrunk=True)
        return [*self.heights(around), *([] if self.odd else [offset]), *self.slanted(), *self.scaling(around)]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        s = s.replaced(load=torch.abs(s.load)) if "load" in self.inputs else s
        if self.dissipative:
            return -smooth_sign(s.speed, p.v_0) * self._level(s, p)
        forward = self._sum(self.scaled(s, p), p)
        if not self.odd:
            return -(forward + p.offset)
        return -0.5 * (forward - self._sum(self.scaled(s.replaced(speed=-s.speed), p), p))

    def _sum(self, sigma: dict[str, Any], p: Signals) -> Any:
        return sum(p[f"out_{k}"] * torch.tanh(self.leaning(sigma, p, k)) for k in range(self.units))

    def _level(self, s: Signals, p: Signals) -> Any:
        """The level of friction, never negative."""
        sigma = self.scaled(s.replaced(speed=torch.abs(s.speed)) if self.odd else s, p)
        return sum(torch.clamp(p[f"out_{k}"], 0.0) * self._bump(sigma, p, k) for k in range(self.units))

    def _bump(self, sigma: dict[str, Any], p: Signals, k: int) -> Any:
        product: Any = 1.0
        for name in self.inputs:
            product = product * torch.exp(
                -((p[f"{own_name(name)}_{k}"] * sigma[name] + p[f"{own_name(name)}_bias_{k}"]) ** 2)
            )
        return product

    def _bumps(self) -> list[Parameter]:
        """Slopes and biases of the bumps, spread over the range of the speed and drawn along the other inputs."""
        rng = np.random.default_rng(self.seed)
        result = []
        for k in range(self.units):
            for name in self.inputs:
                along_speed = name == "speed"
                place = 2.0 * (k + rng.uniform()) / self.units - 1.0 if along_speed else rng.uniform(-1.0, 1.0)
                slope = OVERLAP * (0.5 * self.units if along_speed else 1.0)
                result.append(
                    Parameter(f"{own_name(name)}_{k}", slope, "", description=f"slope of bump {k} over {spoken(name)}")
                )
                result.append(
                    Parameter(f"{own_name(name)}_bias_{k}", -slope * place, "", description=f"place of bump {k}")
                )
        return result
