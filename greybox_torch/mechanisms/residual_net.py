"""A network of any signals at any port: what physics cannot name yet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.network import Network
from greybox_torch.model import Parameter, Signals


class ResidualNet(Network):
    """offset + Σ_k out_k tanh(bias_k + Σ_i w_ik σ_i), an extra force (at an actuator or sensor: a change of the signal)."""

    name = "residual_net"
    kinds = ("body", "coupling", "balance", "actuator", "sensor")
    explanation = "A small network of the local signals stands for physics that has no name yet."

    def __init__(self, inputs: Sequence[str] = ("speed",), units: int = 8, seed: int = 0) -> None:
        super().__init__(inputs, units, seed)

    def parameters(self, around: Surroundings) -> list[Parameter]:
        offset = Parameter("offset", 0.0, around.force_unit, description="constant", shrunk=True)
        return [*self.heights(around), offset, *self.slanted(), *self.scaling(around)]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        sigma = self.scaled(s, p)
        return p.offset + sum(p[f"out_{k}"] * torch.tanh(self.leaning(sigma, p, k)) for k in range(self.units))
