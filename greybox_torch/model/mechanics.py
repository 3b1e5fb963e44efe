"""What the equations of a model say of its mechanics, near its state of zeros: what its inputs drive, and how stiff its couplings are.

An input that is a force at a body changes the rates as that body's port does, times a gain; a linear spring changes them with its
deflection as the coupling's port does, times its stiffness.
"""

from __future__ import annotations

from collections.abc import Callable

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.ports import Body, Coupling
from greybox_torch.model.signals import Signals, parameter_signals

EXACT = 1e-9
"""Share of a column that may be left where two columns are taken to be in proportion: what rounding leaves."""

Column = torch.Tensor


def driven(model: GreyBoxModel, name: str) -> tuple[str, float] | None:
    """The body that an input drives, and the force on it per unit of the input; None where it is no force on one body alone."""
    inputs = [i.name for i in model.inputs]
    by_input = _columns(model, "input")[:, inputs.index(name)]
    ports = _columns(model, "port")
    names = [port.name for port in model.all_ports]
    for body in (port for port in model.all_ports if isinstance(port, Body)):
        gain = _proportion(by_input, ports[:, names.index(body.name)])
        if gain is not None:
            return body.name, gain
    return None


def stiffness(model: GreyBoxModel, coupling: Coupling) -> float | None:
    """Of the model's own linear spring in a coupling; None where its deflection is no state, or does more than wind the spring."""
    states = [s.name for s in model.states]
    if not isinstance(coupling.deflection, str) or coupling.deflection not in states:
        return None
    wound = _columns(model, "state")[:, states.index(coupling.deflection)]
    names = [port.name for port in model.all_ports]
    return _proportion(wound, _columns(model, "port")[:, names.index(coupling.name)])


def _columns(model: GreyBoxModel, by: str) -> Column:
    """Derivatives (n_x, n) of the rates by states, inputs or forces at ports."""
    names = {
        "state": [s.name for s in model.states],
        "input": [i.name for i in model.inputs],
        "port": [port.name for port in model.all_ports],
    }
    p = parameter_signals(model.values())

    def signals(kind: str, values: torch.Tensor | None) -> Signals:
        given = torch.zeros(len(names[kind]), dtype=torch.float64) if values is None else values
        return Signals(kind, dict(zip(names[kind], given, strict=True)))

    def rates(values: torch.Tensor) -> torch.Tensor:
        x, u, port = (signals(kind, values if kind == by else None) for kind in ("state", "input", "port"))
        found = model.derivative(x, u, p, port)
        return torch.stack([torch.as_tensor(found[name], dtype=torch.float64) for name in names["state"]])

    jacobian: Callable[[torch.Tensor], torch.Tensor] = torch.func.jacfwd(rates)
    return jacobian(torch.zeros(len(names[by]), dtype=torch.float64))


def _proportion(column: Column, of: Column) -> float | None:
    """g where ``column`` is g times ``of``; None where it is not, or is zero."""
    size = float(of @ of)
    if not (size > 0.0 and bool(torch.isfinite(column).all())):
        return None
    gain = float(column @ of) / size
    left = float(torch.linalg.vector_norm(column - gain * of))
    return gain if gain != 0.0 and left <= EXACT * float(torch.linalg.vector_norm(column)) else None
