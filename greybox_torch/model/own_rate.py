"""How fast a level or a speed changes by the model's own equations: what a capacity or an inertia multiplies."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import torch

from greybox_torch.model.declarations import Parameter
from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.port_forces import no_forces, with_one
from greybox_torch.model.ports import Balance, Body, Port
from greybox_torch.model.random_points import random_points
from greybox_torch.model.signals import Signals

RATE = "rate@"
"""Beginning of the name of such a signal; the name of its port follows."""


def balanced_state(model: GreyBoxModel, port: Port) -> str | None:
    """The state whose rate a port's force changes: a balance's level, a body's speed; None where that is no state of the model."""
    signal = port.level if isinstance(port, Balance) else port.speed if isinstance(port, Body) else None
    return signal if isinstance(signal, str) and signal in (s.name for s in model.states) else None


def own_rate(model: GreyBoxModel, port: Port, x: Any, u: Any, p: Any, forces: Signals) -> Any:
    """The rate of that state under ``forces`` at the ports, in its unit per second."""
    state = balanced_state(model, port)
    assert state is not None
    return model.derivative(x, u, p, forces)[state]


def without_laws(model: GreyBoxModel, port: Port) -> Callable[[Any, Any, Any], Any]:
    """The rate without any force at the ports, as a signal."""
    return lambda x, u, p: own_rate(model, port, x, u, p, no_forces(model))


def added_to(model: GreyBoxModel, port: Port) -> str | None:
    """The state whose rate a force of one at a port changes by one, whatever the parameters are: then it has the unit of that rate.

    Up or down, where the port says by its signals of no state which it pushes, as a coupling does: it pushes one body and holds another.
    """
    own = balanced_state(model, port)
    changes = [{}, *({q.name: _changed(q.value)} for q in model.declared_parameters)]
    rates = [_raised_rates(model, port, changed) for changed in changes]
    named = [own] if own is not None else [state.name for state in model.states]
    for name in named:
        raised = [torch.as_tensor(one[name]) for one in rates]
        raised = [one for one in raised if torch.isfinite(one).all()]  # a changed parameter may be out of its bounds
        if raised and all(_is_one(one if own is not None else one.abs()) for one in raised):
            return name
    return None


def divided_by(model: GreyBoxModel, port: Port, factor: float = 1.0) -> Parameter | None:
    """The parameter by which a port's force is divided in that rate, a capacity; None where that is not one parameter alone.

    Args:
        factor: by which it is multiplied besides, as where the level has another unit than the model reckons in.
    """
    if balanced_state(model, port) is None:
        return None
    raised = _raised(model, port, {})
    acting = [
        q
        for q in model.declared_parameters
        if not torch.allclose(_raised(model, port, {q.name: _changed(q.value)}), raised, rtol=1e-9)
    ]
    if len(acting) != 1 or not _is_one(raised * acting[0].value / factor):
        return None
    (one,) = acting
    other = _changed(one.value)
    return one if _is_one(_raised(model, port, {one.name: other}) * other / factor) else None


def _changed(value: float) -> float:
    """Another value, farther from zero on the same side: none stays as it is, none is its negative, and none becomes zero."""
    return 2.0 * value + math.copysign(1.0, value)


def _is_one(values: torch.Tensor) -> bool:
    return bool(torch.allclose(values, torch.ones((), dtype=torch.float64), rtol=1e-9))


def _raised(model: GreyBoxModel, port: Port, changed: Mapping[str, float]) -> torch.Tensor:
    """By how much a force of one raises that rate, at random points, with some parameters ``changed``."""
    state = balanced_state(model, port)
    assert state is not None
    return _raised_rates(model, port, changed)[state]


def _raised_rates(model: GreyBoxModel, port: Port, changed: Mapping[str, float]) -> dict[str, torch.Tensor]:
    """The same of every state's rate."""
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    none, p = no_forces(model), p.replaced(**{n: torch.as_tensor(v, dtype=torch.float64) for n, v in changed.items()})
    without, there = (model.derivative(x, u, p, f) for f in (none, with_one(none, port.name)))
    return {name: torch.as_tensor(there[name]) - torch.as_tensor(without[name]) for name in there}
