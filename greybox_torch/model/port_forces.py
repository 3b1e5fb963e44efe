"""Forces at the ports of a model: none, and one at a single port, by which it is seen what a force there changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from greybox_torch.model.signals import Signals

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel


def no_forces(model: GreyBoxModel) -> Signals:
    """No force at any port, in double precision."""
    return Signals("port", dict.fromkeys((q.name for q in model.all_ports), torch.zeros((), dtype=torch.float64)))


def with_one(none: Signals, port: str) -> Signals:
    """A force of one at a port, and what ``none`` has elsewhere."""
    return none.replaced(**{port: none[port] + 1.0})
