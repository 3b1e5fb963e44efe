"""The state through which a change of a coupling's deflection acts: where kinematic mechanisms are attached."""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.model import Coupling, GreyBoxModel, Signals


def shifted_states(model: GreyBoxModel, problem: Problem) -> dict[str, str]:
    """Of every coupling, the state that a change of its deflection amounts to, see :func:`shifted_state`."""
    return {port.name: shifted_state(model, problem, port) for port in model.ports if isinstance(port, Coupling)}


def shifted_state(model: GreyBoxModel, problem: Problem, port: Coupling, *, points: int = 24) -> str:
    """The state through which a change of a coupling's deflection reaches nothing but its spring, as ``+name`` or ``-name``.

    A kinematic mechanism (play, transmission error) changes the deflection that the spring sees. That is the same as moving one state
    that the deflection depends on with slope ±1, provided the rates depend on that state only by way of this coupling: then they
    change in the direction in which the port's force acts. Empty where there is no such state.
    """
    generator = torch.Generator().manual_seed(0)
    n_x, n_u = len(model.states), len(model.inputs)
    scale_u = (
        torch.as_tensor(np.maximum(np.abs(problem.records.u).max(axis=1), 1e-9))
        if n_u
        else torch.ones(0, dtype=torch.float64)
    )
    values = dict(zip(problem.names, problem.values, strict=True))
    p = Signals(
        "parameter", {q.name: torch.tensor(values[q.name], dtype=torch.float64) for q in model.declared_parameters}
    )
    names = [s.name for s in model.states]
    index = port.deflection if isinstance(port.deflection, str) else None
    works = {i: True for i in range(n_x) if index is None or names[i] == index}
    signs: dict[int, float] = {}
    for _ in range(points):
        x = torch.randn(n_x, dtype=torch.float64, generator=generator)
        u = scale_u * torch.randn(n_u, dtype=torch.float64, generator=generator)
        slope, by_state, by_force = _slopes(model, port, x, u, p)
        for i in works:
            change = by_state[:, i]
            along = by_force * (change @ by_force) / (by_force @ by_force)
            parallel = torch.linalg.vector_norm(change - along) <= 1e-8 * torch.linalg.vector_norm(change)
            unit = abs(abs(float(slope[i])) - 1.0) < 1e-9
            works[i] = works[i] and bool(parallel) and unit
            signs[i] = float(slope[i])
    chosen = next((i for i, ok in works.items() if ok), None)
    return "" if chosen is None else ("+" if signs[chosen] > 0 else "-") + names[chosen]


def _slopes(
    model: GreyBoxModel, port: Coupling, x: torch.Tensor, u: torch.Tensor, p: Signals
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Slopes over the states of the deflection (n_x,) and the rates (n_x, n_x), and of the rates over the port's force (n_x,)."""
    slope = torch.func.jacfwd(lambda z: _deflection(model, port, z, u, p))(x)
    by_state = torch.func.jacfwd(lambda z: model.rates(z, u, p))(x)
    by_force = torch.func.jacfwd(lambda f: _forced(model, port.name, x, u, p, f))(torch.zeros((), dtype=torch.float64))
    return slope, by_state, by_force


def _deflection(model: GreyBoxModel, port: Coupling, x: torch.Tensor, u: torch.Tensor, p: Signals) -> torch.Tensor:
    xs = Signals("state", {s.name: x[i] for i, s in enumerate(model.states)})
    us = Signals("input", {s.name: u[i] for i, s in enumerate(model.inputs)})
    return xs[port.deflection] if isinstance(port.deflection, str) else port.deflection(xs, us, p)


def _forced(
    model: GreyBoxModel, port: str, x: torch.Tensor, u: torch.Tensor, p: Signals, force: torch.Tensor
) -> torch.Tensor:
    xs = Signals("state", {s.name: x[i] for i, s in enumerate(model.states)})
    us = Signals("input", {s.name: u[i] for i, s in enumerate(model.inputs)})
    forces = Signals("port", {q.name: force if q.name == port else torch.zeros_like(force) for q in model.all_ports})
    rates = model.derivative(xs, us, p, forces)
    return torch.stack([torch.as_tensor(rates[s.name]) for s in model.states])
