"""The unit of a signal that a model names, or gives as a function of its states."""

from __future__ import annotations

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.ports import Signal
from greybox_torch.model.random_points import random_points


def unit_of_signal(model: GreyBoxModel, signal: Signal) -> str:
    """That of the state which it is, or of the states that it adds and subtracts, as ``x.shoulder + x.elbow``; empty where it is another
    function of them: what a factor does to a unit, the model does not say.
    """
    units = {s.name: s.unit for s in model.states}
    if isinstance(signal, str):
        return units.get(signal, "")
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    here, found = torch.as_tensor(signal(x, u, p)), set()
    for name in x:
        change = torch.as_tensor(signal(x.replaced(**{name: x[name] + 1.0}), u, p)) - here
        if change.any():
            found.add(units[name] if torch.allclose(change.abs(), torch.ones_like(change)) else "")
    return found.pop() if len(found) == 1 else ""
