"""What another part of a machine may do to a port by where that part stands, or how fast it is: other axes and balances."""

from __future__ import annotations

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.joined_bodies import bodies_apart
from greybox_torch.model.ports import Balance, Body, Port, Signal

LEVEL, POSITION, SPEED = "level@", "position@", "speed@"
"""Beginnings of the names of such signals; the name of their port follows."""


def signals_elsewhere(model: GreyBoxModel, port: Port) -> dict[str, Signal]:
    """By name, at a body the positions and speeds of other axes and the levels of balances, at a balance the levels of others.

    A force by the speed of what a spring joins with a body is friction there, or the spring's damping.
    """
    found: dict[str, Signal] = {}
    if isinstance(port, Body):
        there = positions_elsewhere(model, port).items()
        found |= {name: body.position for name, body in there if body.position is not None}
    if isinstance(port, Body | Balance):
        balances = (q for q in model.ports if isinstance(q, Balance) and q.name != port.name)
        found |= {f"{LEVEL}{q.name}": q.level for q in balances}
    if isinstance(port, Body):
        found |= {f"{SPEED}{b.name}": b.speed for b in bodies_apart(model, port)}
    return found


def positions_elsewhere(model: GreyBoxModel, body: Body) -> dict[str, Body]:
    """By the name of their position as a signal, the bodies apart from one (:func:`bodies_apart`) whose positions recordings show.

    Not where nothing depends on a position: where it begins is then not known.
    """
    kept = model.carried_states()
    apart = bodies_apart(model, body)
    return {f"{POSITION}{b.name}": b for b in apart if b.position is not None and b.position not in kept}
