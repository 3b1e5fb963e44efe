"""Inputs that were recorded and that a model does not use: a wind, a room's temperature that nobody has an equation for yet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.port_forces import no_forces
from greybox_torch.model.ports import Actuator, Port
from greybox_torch.model.random_points import random_points
from greybox_torch.model.signals import Signals


def ports_in_use(model: GreyBoxModel) -> list[Port]:
    """All ports but the actuators of idle inputs, where no law of an actuator can do anything."""
    idle = idle_inputs(model)
    return [q for q in model.all_ports if not (isinstance(q, Actuator) and q.input in idle)]


@once_per_model
def idle_inputs(model: GreyBoxModel) -> frozenset[str]:
    """Names of the inputs that neither the rates nor the outputs read. (Not those that move nothing at some points: a dead band is use.)"""
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    told = _Telling(u)
    model.derivative(x, told, p, no_forces(model))
    model.outputs_with(x, told, p, no_forces(model))
    return frozenset(u) - told.names_read


class _Telling(Signals):
    """Inputs that remember which of them were read."""

    names_read: set[str]

    def __init__(self, values: Mapping[str, Any]) -> None:
        super().__init__("input", values)
        for name in values:
            vars(self).pop(name, None)  # so that reading it comes to __getitem__
        vars(self)["names_read"] = set()

    def __getitem__(self, name: str) -> Any:
        self.names_read.add(name)
        return super().__getitem__(name)

    def replaced(self, **values: Any) -> Signals:
        self.names_read.update(self)
        return super().replaced(**values)
