"""Which states a port's signal depends on."""

from __future__ import annotations

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.ports import Signal
from greybox_torch.model.random_points import random_points


def states_of(model: GreyBoxModel, signal: Signal) -> set[str]:
    """Names of the states that move a signal at random points: itself, where it is a state's name."""
    if isinstance(signal, str):
        return {signal}
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    here = torch.as_tensor(signal(x, u, p))
    moved = {s.name: x.replaced(**{s.name: x[s.name] + 1.0}) for s in model.states}
    return {name for name, other in moved.items() if bool((torch.as_tensor(signal(other, u, p)) != here).any())}
