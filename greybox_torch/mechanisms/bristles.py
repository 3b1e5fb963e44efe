"""Bristles between two bodies: how fast they bend, and how short they may be."""

from __future__ import annotations

from typing import Any

import torch

from greybox_torch.mechanisms.slip import slip_share
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.model import Parameter, State

SUDDEN = 8
"""Exponent of the share slipped in the form where slip sets in suddenly, for 1 in Dahl's: near the edge of an elasto-plastic element."""

FASTEST = 1.1
"""Share slipped beyond which that power grows no more: a step that overshoots must not be thrown back."""

SHORTEST = 0.05
"""The least z_0, beside the way of a sample at the highest speed."""

FOLLOWED = 2.0
"""Rate of slipping, per sample, that a step follows: those of Runge-Kutta are stable up to 2.78."""


def bending(speed: Any, bent: Any, yields_at: Any, sample_time: Any, sharpness: Any = None) -> Any:
    """How fast bristles bend that slip at ``yields_at``, no faster than steps of a sample can follow."""
    share, steepest = slip_share(bent, yields_at), 1.0
    if sharpness is not None:
        sudden = torch.clamp(torch.abs(share), max=FASTEST) ** (SUDDEN - 1)
        share = share * (1.0 - sharpness + sharpness * sudden)
        steepest = 1.0 + (SUDDEN - 1) * sharpness
    slipping = steepest * torch.abs(speed) * sample_time / yields_at
    return (speed - torch.abs(speed) * share) / torch.clamp(slipping / FOLLOWED, min=1.0)


def bristle(around: Surroundings) -> State:
    """How far the bristles are bent."""
    return State("bristle", around.units.get("speed", "").replace("/s", ""))


def shortest_bristles(around: Surroundings) -> Parameter:
    """The shortest deflection z_0 at which bristles may slip, fixed."""
    unit, least = around.units.get("speed", "").replace("/s", ""), SHORTEST * shortest_followed(around)
    return Parameter(
        "z_0", least, unit, lower=0.0, fixed=True, description="deflection at which it slips, as short as can be"
    )


def shortest_followed(around: Surroundings) -> float:
    """A bristle deflection whose time constant the sampling still resolves at the highest speed."""
    return around.ranges["speed"].reach * around.sample_time
