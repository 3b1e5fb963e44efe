"""Random points at which a model's equations are looked at, to see what depends on what."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch

from greybox_torch.model.signals import Signals, parameter_signals

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel

POINTS = 16


def random_points(model: GreyBoxModel) -> tuple[torch.Tensor, torch.Tensor, Signals]:
    """States (n_x, POINTS) and inputs (n_u, POINTS), the same at every call, and the parameters as declared."""
    draw = torch.Generator().manual_seed(0)
    x = torch.randn(len(model.states), POINTS, generator=draw, dtype=torch.float64)
    u = torch.randn(len(model.inputs), POINTS, generator=draw, dtype=torch.float64)
    p = parameter_signals({q.name: q.value for q in model.declared_parameters})
    return x, u, p
