"""What the plain model's own free parameters can do at a port: terms that a regression must not mistake for missing physics."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch

from greybox_torch import GreyBoxModel, Signals
from greybox_torch.estimate import Problem
from greybox_torch.model import Actuator

PARALLEL = 1e-6
"""Largest share of a parameter's effect that may lie elsewhere than where a force at the port acts."""


def own_columns(problem: Problem, port: str, states: np.ndarray) -> np.ndarray:
    """Forces at ``port`` (N, k) that are the same as changes of free parameters, along states (N, n_x) of the plain model.

    A change of a parameter changes the rates by ∂f/∂θ. Where that is everywhere along ∂f/∂(force at the port), it is a force there: at a
    body its friction coefficients, at a coupling its stiffness and damping. Parameters that act elsewhere too have no column.
    """
    model = problem.model
    x, u = torch.as_tensor(states.T.copy()), torch.as_tensor(problem.driving_records.u)
    values = torch.as_tensor(problem.values)
    push = _along(lambda force: _rates(model, x, u, problem, values, port, force), torch.zeros((), dtype=torch.float64))
    strength = (push**2).sum(dim=0)
    columns = []
    for k in np.flatnonzero(problem.free):
        unit = torch.zeros_like(values)
        unit[k] = 1.0
        change = torch.func.jvp(
            lambda v: _rates(model, x, u, problem, v, port, torch.zeros_like(values[0])), (values,), (unit,)
        )[1]
        column = (change * push).sum(dim=0) / strength
        beside = change - push * column
        if float((beside**2).sum()) <= PARALLEL**2 * float((change**2).sum()):
            columns.append(column.numpy())
    return np.stack(columns, axis=1) if columns else np.zeros((len(states), 0))


def _along(function: Callable[[torch.Tensor], torch.Tensor], at: torch.Tensor) -> torch.Tensor:
    return torch.func.jvp(function, (at,), (torch.ones_like(at),))[1]


def _rates(
    model: GreyBoxModel,
    x: torch.Tensor,
    u: torch.Tensor,
    problem: Problem,
    values: torch.Tensor,
    port: str,
    force: torch.Tensor,
) -> torch.Tensor:
    """Rates (n_x, N) with ``force`` at a port; at an actuator it adds to the input."""
    site = next(q for q in model.all_ports if q.name == port)
    states = Signals("state", {s.name: x[i] for i, s in enumerate(model.states)})
    inputs = {s.name: u[i] for i, s in enumerate(model.inputs)}
    forces = {q.name: torch.zeros_like(force) for q in model.all_ports}
    if isinstance(site, Actuator):
        inputs[site.input] = inputs[site.input] + force
    else:
        forces[port] = force
    p = Signals("parameter", {n: values[i] for i, n in enumerate(problem.names)})
    rates = model.derivative(states, Signals("input", inputs), p, Signals("port", forces))
    return torch.stack([torch.broadcast_to(torch.as_tensor(rates[s.name]), x.shape[1:]) for s in model.states])
