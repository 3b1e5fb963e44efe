"""The states through which a change of a coupling's deflection acts: where kinematic mechanisms are attached."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.mechanisms import shift
from greybox_torch.model import Coupling, GreyBoxModel, Signals

OTHER = 1.3
"""Times the values of the free parameters, at which a slope has to be the same: a gear ratio that is estimated is another one tomorrow."""


def shifted_states(model: GreyBoxModel, problem: Problem) -> dict[str, str]:
    """Of every coupling, the states that a change of its deflection amounts to, see :func:`shifted_state`."""
    return {port.name: shifted_state(model, problem, port) for port in model.ports if isinstance(port, Coupling)}


def shifted_state(model: GreyBoxModel, problem: Problem, port: Coupling, *, points: int = 24) -> str:
    """The states through which a change of a coupling's deflection reaches nothing but its spring, as :func:`shift.written` has them.

    A kinematic mechanism (play, transmission error) changes the deflection that the spring sees. That is the same as moving one state
    that the deflection depends on with the same slope everywhere, provided the rates depend on that state only by way of this coupling:
    then they change in the direction in which the port's force acts. One with slope ±1 is preferred to one behind a gear. Where no state
    does it, two that move together may: of a motor's angle and a twist, from which a link's angle follows that its weight depends on,
    both move, and the link's angle does not. Empty where nothing does.
    """
    names = [s.name for s in model.states]
    own = names.index(port.deflection) if isinstance(port.deflection, str) else None
    tried, changes = range(len(names)) if own is None else [own], _changes(model, problem, port, points)
    found = _one_state(*changes, tried) or _two_states(*changes, tried)
    return shift.written({names[i]: by for i, by in found.items()})


def _changes(
    model: GreyBoxModel, problem: Problem, port: Coupling, points: int
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """At random points, with the parameters as they are and with the free ones changed: slopes of the deflection (points, n_x), and what a
    state changes of the rates (points, n_x, n_x), the rate first: all of it, and what is not along the direction of the port's force.
    """
    generator = torch.Generator().manual_seed(0)
    n_x, n_u = len(model.states), len(model.inputs)
    scale_u = (
        torch.as_tensor(np.maximum(np.abs(problem.records.u).max(axis=1), 1e-9))
        if n_u
        else torch.ones(0, dtype=torch.float64)
    )
    draws = torch.randn(points, n_x + n_u, dtype=torch.float64, generator=generator).T
    p = problem.parameter_tensors
    elsewhere = p.replaced(**{n: OTHER * p[n] for n, free in zip(problem.names, problem.free, strict=True) if free})
    drawn = (_slopes(model, port, draws[:n_x], scale_u[:, None] * draws[n_x:], one) for one in (p, elsewhere))
    slope, by_state, by_force = (torch.cat(parts, dim=-1).movedim(-1, 0) for parts in zip(*drawn, strict=True))
    share = torch.einsum("kij,ki->kj", by_state, by_force) / (by_force * by_force).sum(dim=1, keepdim=True)
    return slope, by_state, by_state - by_force[:, :, None] * share[:, None, :]


def _one_state(
    slope: torch.Tensor, change: torch.Tensor, beside: torch.Tensor, tried: Iterable[int]
) -> dict[int, float]:
    """The state that changes nothing beside the direction of the port's force: by how much it moves for a change of the deflection by one.

    Other arguments as :func:`_changes` gives them; empty where no state does it.
    """
    per_state = {i: float(slope[0, i]) for i in tried}
    fits = [i for i, by in per_state.items() if _constant(slope[:, i], by) and _little(beside[..., i], change[..., i])]
    chosen = next((i for i in fits if abs(abs(per_state[i]) - 1.0) < 1e-9), next(iter(fits), None))
    return {} if chosen is None else {chosen: 1.0 / per_state[chosen]}


def _two_states(
    slope: torch.Tensor, change: torch.Tensor, beside: torch.Tensor, tried: Iterable[int]
) -> dict[int, float]:
    """The same of two states that move together, the first of them of ``tried``: the second makes up for what the first changes beside."""
    for i, j in ((i, j) for i in tried for j in range(slope.shape[1]) if j != i):
        size = (beside[..., j] ** 2).sum()
        factor = float(-(beside[..., i] * beside[..., j]).sum() / size) if size > 0 else 0.0
        along, left, whole = (part[..., i] + factor * part[..., j] for part in (slope, beside, change))
        if factor and _constant(along, by := float(along[0])) and _little(left, whole):
            return {i: 1.0 / by, j: float(f"{factor / by:.12g}")}  # as a ratio is written, not as rounding leaves it
    return {}


def _constant(slopes: torch.Tensor, value: float) -> bool:
    """Whether the deflection changes with the same slope everywhere."""
    return value != 0.0 and bool((torch.abs(slopes - value) < 1e-9 * abs(value)).all())


def _little(part: torch.Tensor, whole: torch.Tensor) -> bool:
    """Whether a part (points, n_x) of changes of the rates is nothing but rounding, at every point."""
    return bool((torch.linalg.vector_norm(part, dim=1) <= 1e-8 * torch.linalg.vector_norm(whole, dim=1)).all())


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
