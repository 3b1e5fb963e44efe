"""The state through which a change of a coupling's deflection acts: where kinematic mechanisms are attached."""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.mechanisms import shift
from greybox_torch.model import Coupling, GreyBoxModel, Signals

OTHER = 1.3
"""Times the values of the free parameters, at which a slope has to be the same: a gear ratio that is estimated is another one tomorrow."""


def shifted_states(model: GreyBoxModel, problem: Problem) -> dict[str, str]:
    """Of every coupling, the state that a change of its deflection amounts to, see :func:`shifted_state`."""
    return {port.name: shifted_state(model, problem, port) for port in model.ports if isinstance(port, Coupling)}


def shifted_state(model: GreyBoxModel, problem: Problem, port: Coupling, *, points: int = 24) -> str:
    """The state through which a change of a coupling's deflection reaches nothing but its spring, as :func:`shift.written` has it.

    A kinematic mechanism (play, transmission error) changes the deflection that the spring sees. That is the same as moving one state
    that the deflection depends on with the same slope everywhere, provided the rates depend on that state only by way of this coupling:
    then they change in the direction in which the port's force acts. One with slope ±1 is preferred to one behind a gear. Empty where
    there is no such state.
    """
    generator = torch.Generator().manual_seed(0)
    n_x, n_u = len(model.states), len(model.inputs)
    scale_u = (
        torch.as_tensor(np.maximum(np.abs(problem.records.u).max(axis=1), 1e-9))
        if n_u
        else torch.ones(0, dtype=torch.float64)
    )
    names = [s.name for s in model.states]
    index = port.deflection if isinstance(port.deflection, str) else None
    works = {i: True for i in range(n_x) if index is None or names[i] == index}
    slopes_seen: dict[int, float] = {}
    draws = torch.randn(points, n_x + n_u, dtype=torch.float64, generator=generator).T
    p = problem.parameter_tensors
    elsewhere = p.replaced(**{n: OTHER * p[n] for n, free in zip(problem.names, problem.free, strict=True) if free})
    drawn = (_slopes(model, port, draws[:n_x], scale_u[:, None] * draws[n_x:], one) for one in (p, elsewhere))
    slopes = (torch.cat(parts, dim=-1) for parts in zip(*drawn, strict=True))
    for slope, by_state, by_force in zip(*(s.unbind(-1) for s in slopes), strict=True):
        for i in works:
            change = by_state[:, i]
            along = by_force * (change @ by_force) / (by_force @ by_force)
            parallel = torch.linalg.vector_norm(change - along) <= 1e-8 * torch.linalg.vector_norm(change)
            seen = slopes_seen.setdefault(i, float(slope[i]))
            same = seen != 0.0 and abs(float(slope[i]) - seen) < 1e-9 * abs(seen)
            works[i] = works[i] and bool(parallel) and same
    found = [i for i, ok in works.items() if ok]
    chosen = next((i for i in found if abs(abs(slopes_seen[i]) - 1.0) < 1e-9), next(iter(found), None))
    return "" if chosen is None else shift.written(names[chosen], 1.0 / slopes_seen[chosen])


def _slopes(
    model: GreyBoxModel, port: Coupling, x: torch.Tensor, u: torch.Tensor, p: Signals
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Slopes over the states of the deflection (n_x, points) and the rates (n_x, n_x, points), and of the rates over the port's force
    (n_x, points), at states x (n_x, points) and inputs u (n_u, points).
    """
    # Reverse mode, all points at once: torch.func would import torch's compiler, two seconds.
    x, force = x.clone().requires_grad_(), torch.zeros(x.shape[1], dtype=torch.float64, requires_grad=True)
    xs, us = model.named_signals(x, u)
    deflection = xs[port.deflection] if isinstance(port.deflection, str) else port.deflection(xs, us, p)
    forces = Signals("port", {q.name: force if q.name == port.name else force.new_zeros(()) for q in model.all_ports})
    rates = model.derivative(xs, us, p, forces)
    found = [_by(torch.as_tensor(rates[s.name], dtype=torch.float64), (x, force)) for s in model.states]
    by_state, by_force = (torch.stack(parts) for parts in zip(*found, strict=True))
    return _by(deflection, (x,))[0], by_state, by_force


def _by(value: torch.Tensor, unknowns: tuple[torch.Tensor, ...]) -> tuple[torch.Tensor, ...]:
    """Derivatives of a value (points) by each of ``unknowns`` (..., points), point by point."""
    if not value.requires_grad:
        return tuple(torch.zeros_like(q) for q in unknowns)
    return torch.autograd.grad(value.sum(), unknowns, retain_graph=True, allow_unused=True, materialize_grads=True)
