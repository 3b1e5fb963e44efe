"""Values at which equations are tried where recordings are given: recorded inputs and measured states, sample by sample."""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.checking.points import Points
from greybox_torch.estimate.problem import Problem
from greybox_torch.model.sensed_states import sensed_states

MOST_SAMPLES = 2000
"""Samples at most, evenly over all experiments."""

SIZES = (0.0, 1e-3, 0.1, 1.0, 30.0, 1e3, 1e6)
"""Standard deviations of states that no sensor shows, around their start values, a try each; one more try has what is measured in their
unit."""


def recorded_points(problem: Problem) -> tuple[Points, int]:
    """S samples with T tries of the states that no sensor shows, B = S T points with the tries of a sample behind each other; and T.

    No sample is among them that lacks an input or a measured state.
    """
    model, records = problem.model, problem.records
    every = max(1, -(-records.u.shape[1] // MOST_SAMPLES))
    u, y = records.u[:, ::every], records.y[:, ::every]
    outputs, shown = [o.name for o in model.outputs], sensed_states(model)
    seen = {s.name: y[outputs.index(shown[s.name])] for s in model.states if s.name in shown}
    known = np.isfinite(np.vstack([u, *seen.values()])).all(axis=0)
    draw, count, tries = np.random.default_rng(0), int(known.sum()), len(SIZES) + 1
    start = problem.initial[0]
    rows = []
    for k, state in enumerate(model.states):
        if state.name in seen:
            rows.append(np.repeat(seen[state.name][known], tries))
            continue
        alike = [seen[s.name][known] for s in model.states if s.name in seen and s.unit == state.unit]
        drawn = start[k] + draw.normal(size=(count, len(SIZES))) * np.array(SIZES)
        rows.append(np.column_stack([drawn, alike[0] if alike else drawn[:, 0]]).ravel())
    given = (
        np.array(rows),
        np.repeat(u[:, known], tries, axis=1),
        np.repeat(problem.values[:, None], count * tries, axis=1),
    )
    forces = np.zeros((len(model.ports), count * tries))
    return Points(*(torch.as_tensor(row, dtype=torch.float64) for row in (*given, forces))), tries
