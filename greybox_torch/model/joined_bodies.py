"""Which bodies of a model couplings join: they turn about one axis, or move along one line."""

from __future__ import annotations

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.ports import Body, Coupling, value_of
from greybox_torch.model.random_points import random_points
from greybox_torch.model.signals import Signals
from greybox_torch.model.states_of import states_of


@once_per_model
def _at_random(model: GreyBoxModel) -> tuple[Signals, Signals, Signals]:
    """States, inputs and parameters at random points."""
    *points, p = random_points(model)
    return (*model.named_signals(*points), p)


@once_per_model
def joined_bodies(model: GreyBoxModel) -> list[list[Body]]:
    """The bodies in groups that couplings join, both as they are declared; a body that none joins is a group of its own.

    A coupling joins the bodies whose speeds its rate depends on. Speeds that are no states, and rates that are, tell nothing.
    """
    bodies = [port for port in model.ports if isinstance(port, Body)]
    groups = [[body] for body in bodies]
    x, u, p = _at_random(model)
    for coupling in (port for port in model.ports if isinstance(port, Coupling)):
        joined = {body.name for body in bodies if turns_with(coupling, body, x, u, p)}
        together = [group for group in groups if joined & {body.name for body in group}]
        if len(together) > 1:
            one = [body for body in bodies if any(body in group for group in together)]
            groups = [one if group is together[0] else group for group in groups if group not in together[1:]]
    return groups


def bodies_apart(model: GreyBoxModel, body: Body) -> list[Body]:
    """The bodies that no coupling joins with a body, as they are declared: other axes of a machine.

    None where a coupling does not tell which bodies it joins (its rate is a state, or a speed is none), nor those whose position depends
    on the same states as the body's: what a rigid gear moves is no other axis.
    """
    bodies = [port for port in model.ports if isinstance(port, Body)]
    couplings = [port for port in model.ports if isinstance(port, Coupling)]
    untold = any(isinstance(c.rate, str) for c in couplings) or any(not isinstance(b.speed, str) for b in bodies)
    if couplings and untold:
        return []
    own = set() if body.position is None else states_of(model, body.position)
    groups = joined_bodies(model)
    apart = [other for group in groups if body.name not in {b.name for b in group} for other in group]
    return [b for b in apart if not own or b.position is None or states_of(model, b.position) != own]


def turns_with(coupling: Coupling, body: Body, x: Signals, u: Signals, p: Signals) -> bool:
    """Whether a body's speed is one of the two that make a coupling's deflection change, seen at states ``x`` and inputs ``u``."""
    if not isinstance(body.speed, str) or isinstance(coupling.rate, str):
        return False
    faster = x.replaced(**{body.speed: x[body.speed] + 1.0})
    return bool(torch.as_tensor(coupling.rate(faster, u, p) != coupling.rate(x, u, p)).any())


def to_ground(model: GreyBoxModel, coupling: Coupling, body: Body) -> bool:
    """Whether a coupling holds one body to what stands still: it deflects as that body moves.

    What repeats along the body's travel acts on it there as a force, whether in the spring or beside it.
    """
    if coupling.rate is None:
        return False
    rate, speed = (torch.as_tensor(value_of(signal, *_at_random(model))) for signal in (coupling.rate, body.speed))
    return bool((rate == speed).all())
