"""Positions that no sensor shows, from measured speeds.

Brought along by simulation, such a position goes where the model goes: with an effect that follows it at the wrong place, windows run
a little too far or not far enough, and the next ones begin there. The integral of a measured speed knows nothing of the model.
"""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.measured_states import measured_at
from greybox_torch.estimate.problem import Problem
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.random_points import random_points
from greybox_torch.model.sensed_states import sensed_states


def integrated_speeds(problem: Problem, samples: np.ndarray) -> dict[int, np.ndarray]:
    """How far each carried state whose rate is a measured state has gone at some samples (W,) since its experiment began, by number;
    without those of which no sample is known.
    """
    model, records, states = problem.model, problem.records, problem.model.states
    names, found = [s.name for s in states], {}
    everywhere = np.arange(records.y.shape[1])
    for position, speed in _measured_rates(model).items():
        i = names.index(position)
        if problem.carried[i]:
            measured = measured_at(model, states[names.index(speed)], records, everywhere)
            if np.isnan(measured).any():
                continue
            steps = 0.5 * (measured[:-1] + measured[1:]) * records.dt[:-1]
            gone = np.concatenate([[0.0], np.cumsum(steps)])
            found[i] = gone[samples] - gone[records.first[records.experiments(samples)]]
    return found


@once_per_model
def _measured_rates(model: GreyBoxModel) -> dict[str, str]:
    """By state, the state that is its rate at every point, and that a sensor shows as it is, whatever the parameters."""
    x, u, p = random_points(model)
    moved = Signals("parameter", {name: 1.1 * value + 0.1 for name, value in p.items()})
    with torch.no_grad():
        rates, y = model.rates(x, u, moved), model.measured(x, u, moved)
    names, outputs, sensed = [s.name for s in model.states], [o.name for o in model.outputs], sensed_states(model)

    def shown(k: int, name: str) -> bool:
        return name in sensed and torch.equal(y[outputs.index(sensed[name])], x[k])

    return {
        position: speed
        for i, position in enumerate(names)
        for k, speed in enumerate(names)
        if shown(k, speed) and torch.equal(rates[i], x[k])
    }
