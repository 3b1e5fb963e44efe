"""Which outputs show a state as it is, whatever they are called."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import torch

from greybox_torch.model.signals import Signals

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel

POINTS = 16
"""Random states and inputs at which the outputs are looked at."""

_KNOWN: WeakKeyDictionary[GreyBoxModel, dict[str, str]] = WeakKeyDictionary()


def sensed_states(model: GreyBoxModel) -> dict[str, str]:
    """By state, the name of the output that shows it: the one of the same name, or one that is equal to it at every point.

    Of a model with effects it is the plain one that tells: what a sensor adds does not make it another sensor.
    """
    plain = model.plain
    if plain not in _KNOWN:
        _KNOWN[plain] = _found(plain)
    return _KNOWN[plain]


def _found(model: GreyBoxModel) -> dict[str, str]:
    draw = torch.Generator().manual_seed(0)
    x = torch.randn(len(model.states), POINTS, generator=draw, dtype=torch.float64)
    u = torch.randn(len(model.inputs), POINTS, generator=draw, dtype=torch.float64)
    p = Signals("parameter", {q.name: torch.tensor(q.value, dtype=torch.float64) for q in model.declared_parameters})
    with torch.no_grad():
        y = model.measured(x, u, p)
    names = [o.name for o in model.outputs]
    found = {}
    for i, state in enumerate(model.states):
        equal = [name for k, name in enumerate(names) if torch.equal(y[k], x[i])]
        if state.name in names or equal:
            found[state.name] = state.name if state.name in names else equal[0]
    return found
