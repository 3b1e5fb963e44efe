"""Balances that stand for what two others exchange: the plates between the two sides of a heat exchanger, a pipe between two tanks."""

from __future__ import annotations

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.port_forces import no_forces
from greybox_torch.model.ports import Balance, value_of
from greybox_torch.model.random_points import random_points
from greybox_torch.model.signals_elsewhere import difference

NEAR = 1e-9
"""Relative difference between what is the same."""


def exchange_between(model: GreyBoxModel, one: Balance, other: Balance) -> Balance | None:
    """The balance of the model whose level is the difference of two balances' levels, and whose force goes from one of them to the other.

    What the two exchange is told there. None where the model has no such balance.
    """
    others = (q for q in model.ports if isinstance(q, Balance) and q.name not in (one.name, other.name))
    return next((q for q in others if _stands_between(model, q, one, other)), None)


def _stands_between(model: GreyBoxModel, between: Balance, one: Balance, other: Balance) -> bool:
    """Whether a balance is what two others exchange, in either direction, seen at random points."""
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    level, apart = (torch.as_tensor(value_of(s, x, u, p)) for s in (between.level, difference(one, other)))
    if not any(torch.allclose(level, sign * apart, rtol=NEAR) for sign in (1.0, -1.0)):
        return False
    none, force = no_forces(model), torch.ones((), dtype=torch.float64)

    def moved(**forces: torch.Tensor) -> torch.Tensor:
        rates = model.derivative(x, u, p, none.replaced(**forces))
        return torch.stack([torch.as_tensor(rates[s.name]) + 0.0 * level for s in model.states])

    there = moved(**{between.name: force})
    return any(
        torch.allclose(there, moved(**{one.name: sign * force, other.name: -sign * force}), rtol=NEAR)
        for sign in (1.0, -1.0)
    )
