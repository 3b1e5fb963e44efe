"""Which mechanisms can be attached where."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.forces import Gravity, TorqueRipple
from greybox_torch.mechanisms.friction import PositionDependentFriction
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.transmission import TransmissionError
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body, Coupling, GreyBoxModel, Port, Signals
from greybox_torch.model.ports import driving_body

LEAST_RIPPLE_ORDER = 1.2
"""Below this order a force periodic in an angle is gravity's, not ripple."""

ANGLES = ("rad", "deg", "rev", "turn")
"""Beginnings of the units of angles: only on an angle does gravity repeat."""

FLEXIBLE = {
    "body": ("speed", "position"),
    "coupling": ("deflection", "rate"),
    "balance": ("level",),
    "actuator": ("input",),
}
"""Signals that the flexible curve is tried over, by kind of port."""

GAINS = {"actuator": (("time", "input"), ("speed", "input")), "coupling": (("speed", "rate"),)}
"""By kind of port, signals over which the gain of another may change: a battery that sags, a motor whose field weakens with its speed,
a damper whose oil is torn along.
"""


PERIODIC = (TorqueRipple, PositionDependentFriction, TransmissionError)
"""Mechanisms whose order has to be found in the data first."""


def candidates(
    model: GreyBoxModel,
    shifts: Mapping[str, str],
    surroundings: Mapping[str, Surroundings],
    *,
    flexible: bool,
    knots: int = 14,
) -> list[Attachment]:
    """Every mechanism of the library at every port that it fits (or, with ``flexible``, the unknown curves).

    Args:
        shifts: by coupling, see :func:`shifted_states`.
        knots: of the unknown curves.
    """
    found = []
    for port in model.all_ports:
        shifted = shifts.get(port.name, "")
        for mechanism in _curves(port, knots) if flexible else (m() for m in LIBRARY.values()):
            if (
                port.kind in mechanism.kinds
                and _available(mechanism, surroundings[port.name])
                and (shifted or not mechanism.kinematic)
            ):
                found.append(attach(model, port.name, mechanism, shifted))
    return found


def periodic_candidates(
    model: GreyBoxModel,
    shifts: Mapping[str, str],
    surroundings: Mapping[str, Surroundings],
    orders: Iterable[float],
) -> list[Attachment]:
    """Periodic mechanisms at every port that they fit, at the given orders (gravity, order one, stands by itself)."""
    found = []
    for order in orders:
        for port in model.ports:
            if isinstance(port, Body):
                found.append(attach(model, port.name, PositionDependentFriction(order)))
                if order > LEAST_RIPPLE_ORDER or not _is_angle(surroundings[port.name]):
                    found.append(attach(model, port.name, TorqueRipple(order)))
            elif isinstance(port, Coupling) and driving_body(model.ports) is not None:
                shifted = shifts.get(port.name, "")
                if shifted:
                    found.append(attach(model, port.name, TransmissionError(order), shifted))
    return found


def _curves(port: Port, knots: int) -> Iterable[Unknown]:
    yield from (Unknown(signal, knots) for signal in FLEXIBLE.get(port.kind, ()))
    yield from (Unknown(signal, knots, factor) for signal, factor in GAINS.get(port.kind, ()))


def _is_angle(around: Surroundings) -> bool:
    return around.units.get("position", "").startswith(ANGLES) or not around.units.get("position", "")


def _available(mechanism: Mechanism, around: Surroundings) -> bool:
    if isinstance(mechanism, Gravity | PositionDependentFriction | TorqueRipple) and not _is_angle(around):
        return False  # as the library offers them they repeat once per turn; periodic_candidates has those with other periods
    needed = set(mechanism.needs) - {"delayed"}
    if isinstance(mechanism, Unknown):
        needed = set(mechanism.signals())
    return needed <= set(around.ranges)


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
        torch.as_tensor(np.maximum(np.abs(problem.tape.u).max(axis=1), 1e-9))
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
