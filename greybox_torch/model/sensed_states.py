"""Which outputs show a state as it is, whatever they are called."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.random_points import random_points

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel


def sensed_states(model: GreyBoxModel) -> dict[str, str]:
    """By state, the name of the output that shows it: the one of the same name, or one that is equal to it at every point.

    Of a model with effects it is the plain one that tells: what a sensor adds does not make it another sensor.
    """
    return _sensed(model.plain)


@once_per_model
def _sensed(model: GreyBoxModel) -> dict[str, str]:
    x, u, p = random_points(model)
    with torch.no_grad():
        y = model.measured(x, u, p)
    names = [o.name for o in model.outputs]
    found = {}
    for i, state in enumerate(model.states):
        equal = [name for k, name in enumerate(names) if torch.equal(y[k], x[i])]
        if state.name in names or equal:
            found[state.name] = state.name if state.name in names else equal[0]
    return found
