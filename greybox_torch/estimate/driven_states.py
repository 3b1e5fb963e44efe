"""States that inputs alone drive: a fan's thrust behind its voltage, the current of a winding without back-EMF.

No sensor shows them, and none needs to: whatever the rest of the machine does, they follow from the inputs.
"""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.free_run import visited_states
from greybox_torch.estimate.kinematics import kinematics_of
from greybox_torch.estimate.problem import Problem
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.random_points import random_points
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.simulation.simulator import Simulator


@once_per_model
def driven_states(model: GreyBoxModel) -> tuple[int, ...]:
    """The indices of the states whose rates depend on inputs, parameters and one another alone, and that inputs do move.

    Of those that no sensor shows, and that do not follow from what one shows: forces that the model lacks act on these.
    """
    sensed, relations = sensed_states(model), kinematics_of(model)
    seen = {i for i, s in enumerate(model.states) if s.name in sensed}
    seen |= set() if relations is None else set(relations.hidden[relations.determined])
    x, u, p = random_points(model)
    with torch.no_grad():
        rates = model.rates(x, u, p)
        by_states = np.array([(model.rates(_moved(x, j), u, p) != rates).any(dim=1).numpy() for j in range(len(x))])
        by_inputs = np.array([(model.rates(x, _moved(u, k), p) != rates).any(dim=1).numpy() for k in range(len(u))])
    moved = set(np.flatnonzero(by_inputs.any(axis=0)))
    while further := {i for i in range(len(x)) if i not in moved and any(by_states[j, i] for j in moved)}:
        moved |= further
    driven = moved - seen
    while others := {i for i in driven if any(by_states[j, i] for j in range(len(x)) if j not in driven)}:
        driven -= others
    return tuple(sorted(map(int, driven)))


def _moved(rows: torch.Tensor, index: int) -> torch.Tensor:
    moved = rows.clone()
    moved[index] = moved[index] + 1.0
    return moved


def simulated_driven(problem: Problem, simulator: Simulator) -> dict[int, np.ndarray]:
    """The driven states (N,) by index at the samples of the records, simulated at the problem's values; without those that overflow."""
    indices = driven_states(problem.model.plain)
    if not indices:
        return {}
    states = np.concatenate(visited_states(problem, simulator))
    return {i: states[:, i] for i in indices if np.isfinite(states[:, i]).all()}
