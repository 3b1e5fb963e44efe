"""What an input does in the direction of a body's motion: positive where it drives, negative where it brakes."""

from __future__ import annotations

from typing import Any

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.own_rate import balanced_state, own_rate
from greybox_torch.model.port_forces import no_forces
from greybox_torch.model.ports import Body
from greybox_torch.model.random_points import random_points

ALONG, DIRECTION = "along@", "direction@"
"""Beginnings of the names of such a signal, where the input's name follows, and of the direction itself, where the body's follows."""

SHARP = 0.02
"""Part of the root mean square speed by which the direction has changed."""


def direction(speed: Any, rms: float) -> Any:
    """The direction of motion, from -1 to 1, smooth about rest.

    Args:
        rms: root mean square of the speed in the recordings.
    """
    return torch.tanh(torch.as_tensor(speed) / (SHARP * max(rms, 1e-12)))


def inputs_that_push(model: GreyBoxModel, body: Body) -> list[str]:
    """The inputs on which the rate of a body's speed depends; none where that is no state of the model."""
    if balanced_state(model, body) is None:
        return []
    x, u, p = random_points(model)
    none, found = no_forces(model), []
    here = own_rate(model, body, *model.named_signals(x, u), p, none)
    for row, one in enumerate(model.inputs):
        moved = u.clone()
        moved[row] += 1.0
        there = own_rate(model, body, *model.named_signals(x, moved), p, none)
        if bool(torch.as_tensor(there != here).any()):
            found.append(one.name)
    return found
