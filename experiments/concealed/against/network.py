"""A plain model with a neural network for what it lacks: the black box that keeps the known equations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch import Body, GreyBoxModel, Parameter, Signals
from greybox_torch.estimate import Problem, visited_states
from greybox_torch.simulation import Simulator


class NetworkModel(GreyBoxModel):
    """``base`` with a force W_2 tanh(W_1 z + b) + c at every body (every port, where there is no body), z being all states and inputs.

    States and inputs are scaled by their root mean square, forces by ``scales``; all of these are fixed parameters. The network is drawn
    small and with output weights zero, so that training begins at the plain model.

    Args:
        spread: of states, then inputs (n_x + n_u,).
        forces: what a weight of one amounts to at each of the ports, in the port's unit.
    """

    def __init__(
        self, base: GreyBoxModel, width: int, spread: np.ndarray, forces: Sequence[float], *, seed: int
    ) -> None:
        self.width = width
        self.name = base.title  # type: ignore[misc]
        self.states, self.inputs, self.outputs, self.ports = base.states, base.inputs, base.outputs, list(base.ports)
        self.signals = [*(s.name for s in base.states), *(i.name for i in base.inputs)]
        self.places = ports_of(base)
        self.declared_parameters = (*base.declared_parameters, *self._weights(spread, forces, seed))
        super().__init__()
        self.base = base

    def _weights(self, spread: np.ndarray, forces: Sequence[float], seed: int) -> list[Parameter]:
        rng = np.random.default_rng(seed)
        share = 1.0 / np.sqrt(len(self.signals))
        result = [Parameter(f"scale.{n}", float(s), fixed=True) for n, s in zip(self.signals, spread, strict=True)]
        result += [Parameter(f"force.{n}", float(f), fixed=True) for n, f in zip(self.places, forces, strict=True)]
        for k in range(self.width):
            result += [Parameter(f"in.{k}.{n}", float(rng.normal(0.0, share))) for n in self.signals]
            result.append(Parameter(f"bias.{k}", float(rng.normal(0.0, 0.5))))
        for place in self.places:
            result += [Parameter(f"out.{place}.{k}", 0.0) for k in range(self.width)]
            result.append(Parameter(f"offset.{place}", 0.0))
        return result

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        z = [x[s.name] / p[f"scale.{s.name}"] for s in self.states] + [
            u[i.name] / p[f"scale.{i.name}"] for i in self.inputs
        ]
        hidden = [
            torch.tanh(sum(p[f"in.{k}.{n}"] * value for n, value in zip(self.signals, z, strict=True)) + p[f"bias.{k}"])
            for k in range(self.width)
        ]
        forces = dict(port)
        for place in self.places:
            out = sum(p[f"out.{place}.{k}"] * h for k, h in enumerate(hidden)) + p[f"offset.{place}"]
            forces[place] = forces[place] + p[f"force.{place}"] * out
        return self.base.derivative(x, u, p, Signals("port", forces))

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return self.base.output(x, u, p)

    def admissible(self, p: Any) -> dict[str, Any]:
        return self.base.admissible(p)


def ports_of(base: GreyBoxModel) -> list[str]:
    """Where the network pushes: at the bodies, or where there are none at all declared ports."""
    bodies = [port.name for port in base.ports if isinstance(port, Body)]
    return bodies or [port.name for port in base.ports]


def network_model(problem: Problem, simulator: Simulator, width: int, *, seed: int) -> NetworkModel:
    """A network scaled to where the signals of ``problem`` move in free run and to the forces that act there."""
    base, states = problem.model, np.concatenate(visited_states(problem, simulator))
    both = np.concatenate([states, problem.records.u.T], axis=1)
    spread = np.sqrt(np.mean(both**2, axis=0))
    values = problem.values_by_name
    forces = [force_scale(base, place, states, problem.records.u.T, values) for place in ports_of(base)]
    return NetworkModel(base, width, np.where(spread > 0, spread, 1.0), forces, seed=seed)


def force_scale(
    base: GreyBoxModel, place: str, states: np.ndarray, inputs: np.ndarray, values: dict[str, float]
) -> float:
    """Root mean square of the net force (port's unit) that already acts there, along states (N, n_x) and inputs (N, n_u)."""
    x = Signals("state", {s.name: torch.as_tensor(states[:, i]) for i, s in enumerate(base.states)})
    u = Signals("input", {s.name: torch.as_tensor(inputs[:, i]) for i, s in enumerate(base.inputs)})
    p = Signals(
        "parameter",
        {d.name: torch.tensor(float(values[d.name]), dtype=torch.float64) for d in base.declared_parameters},
    )
    nothing = {port.name: torch.zeros((), dtype=torch.float64) for port in base.all_ports}
    pushed = {**nothing, place: torch.ones((), dtype=torch.float64)}
    still, moved = (base.derivative(x, u, p, Signals("port", forces)) for forces in (nothing, pushed))
    sizes = []
    for name, rate in still.items():
        effect = torch.as_tensor(moved[name] - rate).abs().mean()
        if effect > 0:
            sizes.append(float(torch.as_tensor(rate).square().mean().sqrt() / effect))
    return min(sizes, default=1.0) or 1.0
