"""The dry friction that a model has at a body already."""

from __future__ import annotations

from collections.abc import Mapping

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.port_forces import no_forces, with_one
from greybox_torch.model.ports import Body
from greybox_torch.model.signals import parameter_signals

NEAR_REST = 0.1
"""Share of the fastest speed by which rounded dry friction has come to its level."""

NOT_NEGLIGIBLE = 0.01
"""Share of the force at the fastest speed from which its level counts."""


def dry_friction(model: GreyBoxModel, body: Body, fastest: float, values: Mapping[str, float]) -> float:
    """The level of the force on ``body`` that changes its sign about rest and hardly grows with speed, in the unit of its port.

    It is where the straight line through the force near rest and at the fastest speed, mean of both directions, meets rest, all other
    states and the inputs at zero. Zero where the speed is no state of the model, so that it cannot be changed alone.

    Args:
        fastest: the largest speed, in the model's unit.
        values: parameters by name.
    """
    near, whole = _forces(model, body, fastest, values)
    return (near - NEAR_REST * whole) / (1.0 - NEAR_REST)


def has_dry_friction(model: GreyBoxModel, fastest: Mapping[str, float], values: Mapping[str, float]) -> bool:
    """Whether a model has dry friction at some body.

    Args:
        fastest: by state, the largest speed, in the model's unit; bodies of which none is known are left out.
        values: parameters by name.
    """
    for body in model.ports:
        most = fastest.get(body.speed, 0.0) if isinstance(body, Body) and isinstance(body.speed, str) else 0.0
        if isinstance(body, Body) and most > 0.0:
            whole = abs(_forces(model, body, most, values)[1])
            if dry_friction(model, body, most, values) > NOT_NEGLIGIBLE * whole:
                return True
    return False


def _forces(model: GreyBoxModel, body: Body, fastest: float, values: Mapping[str, float]) -> tuple[float, float]:
    """The force against the motion near rest and at the fastest speed, mean of both directions; zeros where the speed is no state."""
    names, speed = [s.name for s in model.states], body.speed
    if not isinstance(speed, str) or speed not in names:
        return 0.0, 0.0
    at, parts = names.index(speed), (-1.0, -NEAR_REST, NEAR_REST, 1.0)
    x = torch.zeros(len(names), len(parts), dtype=torch.float64)
    x[at] = fastest * torch.tensor(parts, dtype=torch.float64)
    u = torch.zeros(len(model.inputs), len(parts), dtype=torch.float64)
    p = parameter_signals(values)
    none = no_forces(model)
    here, there = (
        torch.as_tensor(model.derivative(*model.named_signals(x, u), p, forces)[speed]).expand(len(parts))
        for forces in (none, with_one(none, body.name))
    )
    force = here / (there - here)
    return float(force[1] - force[2]) / 2, float(force[0] - force[3]) / 2
