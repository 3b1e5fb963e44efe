"""Which states and inputs a signal depends on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.ports import Signal
from greybox_torch.model.random_points import random_points
from greybox_torch.model.signals import Signals


def states_of(model: GreyBoxModel, signal: Signal) -> set[str]:
    """Names of the states that move a signal at random points: itself, where it is a state's name."""
    if isinstance(signal, str):
        return {signal}
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    return set(_moving(x, lambda other: signal(other, u, p)))


def inputs_of(model: GreyBoxModel, signal: Callable[[Any, Any, Any], Any]) -> list[str]:
    """Names of the inputs that move a signal at random points, in the model's order."""
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    return _moving(u, lambda other: signal(x, other, p))


def _moving(among: Signals, value: Callable[[Signals], Any]) -> list[str]:
    """Those of some values that change another one if they are larger by one."""
    here = torch.as_tensor(value(among))
    moved = {name: among.replaced(**{name: among[name] + 1.0}) for name in among}
    return [name for name, other in moved.items() if bool((torch.as_tensor(value(other)) != here).any())]
