"""A network with hidden states at any port: what is missing and remembers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.network import own_name, spoken
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.model import Parameter, Signals, State

MOST_MEMORIES = 4


class MemoryNet(ResidualNet):
    """offset + Σ_k out_k tanh(bias_k + Σ_i w_ik σ_i + Σ_j m_jk h_j), with hidden states T_j dh_j/dt = tanh(c_j + Σ_i a_ij σ_i) − h_j.

    The hidden states are without unit and begin at zero; their time constants T_j are spread between a few and a hundred samples to begin
    with. One that is not needed does no harm: the output weights are held weakly towards zero.

    Raises:
        UserError: as :class:`ResidualNet`, or a number of ``memories`` that is none.
    """

    name = "memory_net"
    explanation = "A small network with hidden states stands for physics that remembers and has no name yet."
    source = "K. Funahashi, Y. Nakamura, Neural Networks 6, 1993 (continuous-time recurrent networks)"

    def __init__(self, inputs: Sequence[str] = ("speed",), units: int = 8, seed: int = 0, memories: int = 1) -> None:
        super().__init__(inputs, units, seed)
        self.memories = memories
        if isinstance(memories, bool) or not (isinstance(memories, int) and 1 <= memories <= MOST_MEMORIES):
            raise UserError(f"{self.name}: memories is {memories!r}; expected a whole number from 1 to {MOST_MEMORIES}")

    def parameters(self, around: Surroundings) -> list[Parameter]:
        rng, step = np.random.default_rng(self.seed + 1), around.sample_time
        result = super().parameters(around)
        for j, samples in enumerate(np.geomspace(10.0, 100.0, self.memories) if self.memories > 1 else [30.0]):
            result.append(
                Parameter(f"T_{j}", samples * step, "s", lower=2 * step, upper=1e4 * step, description="memory")
            )
            result.append(Parameter(f"c_{j}", 0.0, "", description=f"bias of hidden state {j}"))
            for name in self.inputs:
                result.append(
                    Parameter(
                        f"a_{own_name(name)}_{j}",
                        float(rng.normal()),
                        "",
                        description=f"{spoken(name)} in hidden state {j}",
                    )
                )
            for k in range(self.units):
                result.append(
                    Parameter(f"m_{j}_{k}", float(rng.normal()), "", description=f"hidden state {j} in unit {k}")
                )
        return result

    def states(self, around: Surroundings) -> list[State]:
        return [State(f"h_{j}", "") for j in range(self.memories)]

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        sigma = self.scaled(s, p)
        return {
            f"h_{j}": (
                torch.tanh(p[f"c_{j}"] + sum(p[f"a_{own_name(name)}_{j}"] * sigma[name] for name in self.inputs))
                - z[f"h_{j}"]
            )
            / p[f"T_{j}"]
            for j in range(self.memories)
        }

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        sigma = self.scaled(s, p)

        def unit(k: int) -> Any:
            remembered = sum(p[f"m_{j}_{k}"] * z[f"h_{j}"] for j in range(self.memories))
            return p[f"out_{k}"] * torch.tanh(self.leaning(sigma, p, k) + remembered)

        return p.offset + sum(unit(k) for k in range(self.units))
