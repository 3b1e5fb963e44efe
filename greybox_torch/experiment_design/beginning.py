"""How a next recording begins: as one of the earlier ones did, at rest where one did, or with states that are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import torch

from greybox_torch.experiment_design.contender import Contender
from greybox_torch.model import Body, GreyBoxModel
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.random_points import random_points

AT_REST = 0.02
"""Share of a speed's largest size along the recordings up to which it counts as none."""


@dataclass(frozen=True)
class Beginning:
    """As the recording ``like`` began, but for the states ``given``. ``moving``: the speeds that are not zero then; ``resting``: those that
    are, but for what an estimate of a start state is uncertain by.
    """

    like: str
    given: Mapping[str, float] = field(default_factory=dict)
    moving: tuple[str, ...] = ()
    resting: tuple[str, ...] = ()


def beginning_of(one: Contender, given: Mapping[str, float]) -> Beginning:
    """As the first recording began; where that is in motion, as the first one did that is at rest, if any is.

    Args:
        given: states that are asked for, by name; with any, all others are those of the first recording.
    """
    names, tried = one.problem.records.names, [_moving(one, row, given) for row in one.problem.initial]
    k = 0 if given else next((k for k, moving in enumerate(tried) if not moving), 0)
    speeds = [name for name in speeds_of(one.problem.model.plain) if name not in given]
    return Beginning(names[k], given, tried[k], tuple(name for name in speeds if name not in tried[k]))


def _moving(one: Contender, start: np.ndarray, given: Mapping[str, float]) -> tuple[str, ...]:
    """The speeds that begin with more than a small share of the largest they had, of start states (n_x,)."""
    names = [s.name for s in one.problem.model.states]
    places = [names.index(name) for name in speeds_of(one.problem.model.plain)]
    return tuple(names[i] for i in places if abs(given.get(names[i], start[i])) > AT_REST * one.reach[i])


@once_per_model
def speeds_of(model: GreyBoxModel) -> tuple[str, ...]:
    """The states that are the speed of a body, or the rate of another state at every point."""
    x, u, p = random_points(model)
    with torch.no_grad():
        rates = model.rates(x, u, p)
    bodies = {port.speed for port in model.ports if isinstance(port, Body)}
    return tuple(
        s.name for k, s in enumerate(model.states) if s.name in bodies or any(torch.equal(rate, x[k]) for rate in rates)
    )
