"""The force that a coupling's spring transmits, from the rates of a model that does not tell it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from greybox_torch.mechanisms import shift
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.port_forces import with_one
from greybox_torch.model.ports import value_of
from greybox_torch.model.random_points import random_points


def moved_states(base: GreyBoxModel, coupling: str, none: Signals) -> list[str]:
    """The states whose rates a force at a coupling changes.

    Args:
        none: no force at any port.
    """
    *points, p = random_points(base)
    x, u = base.named_signals(*points)
    here, pushed = (base.derivative(x, u, p, forces) for forces in (none, with_one(none, coupling)))
    return [s.name for s in base.states if torch.as_tensor(pushed[s.name] != here[s.name]).any()]


def spring_force(
    base: GreyBoxModel,
    coupling: str,
    shifted_state: str,
    moved: Sequence[str],
    x: Signals,
    u: Signals,
    p: Signals,
    none: Signals,
) -> Any:
    """The force at states ``x``, in the unit of a force at the port and with its sign.

    Moving the states that a change of the deflection amounts to until the deflection is zero changes the rates by the spring's force alone,
    along the direction in which a force at the port changes them (:func:`greybox_torch.estimate.shifted_states.shifted_state`).

    Args:
        shifted_state: those states, see :func:`greybox_torch.mechanisms.shift.written`.
        moved: from :func:`moved_states`.
        none: no force at any port.
    """
    site = next(q for q in base.all_ports if q.name == coupling)
    deflection = value_of(site.signals["deflection"], x, u, p)
    released = shift.moved(x, shifted_state, -deflection)
    here, without = (base.derivative(s, u, p, none) for s in (x, released))
    # Where the spring is released, as beside its force one of one would be lost to rounding.
    pushed = base.derivative(released, u, p, with_one(none, coupling))
    along = {s: pushed[s] - without[s] for s in moved}
    return sum((here[s] - without[s]) * along[s] for s in moved) / sum(a * a for a in along.values())
