"""What another part of a machine may do to a port by where that part stands: positions of other axes, levels of other balances."""

from __future__ import annotations

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.joined_bodies import bodies_apart
from greybox_torch.model.ports import Balance, Body, Port, Signal

LEVEL, POSITION = "level@", "position@"
"""Beginnings of the names of such signals; the name of their port follows."""


def signals_elsewhere(model: GreyBoxModel, port: Port) -> dict[str, Signal]:
    """By name, at a body the positions of bodies that no coupling joins with it and the levels of balances, at a balance other levels."""
    found: dict[str, Signal] = {}
    if isinstance(port, Body):
        others = bodies_apart(model, port)
        found |= {f"{POSITION}{b.name}": b.position for b in others if b.position is not None}
    if isinstance(port, Body | Balance):
        balances = (q for q in model.ports if isinstance(q, Balance) and q.name != port.name)
        found |= {f"{LEVEL}{q.name}": q.level for q in balances}
    return found
