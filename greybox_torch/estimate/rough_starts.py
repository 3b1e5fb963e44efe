"""A first guess of the states at which windows of a record begin."""

from __future__ import annotations

import numpy as np

from greybox_torch.estimate.kinematics import hidden_starts
from greybox_torch.estimate.measured_states import measured_at
from greybox_torch.estimate.problem import Problem
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.simulation.windows import Windows


def rough_starts(problem: Problem, windows: Windows) -> np.ndarray:
    """Start states (W, n_x) from the measurement where a state is measured or follows from one that is, else as the experiment begins."""
    experiment = problem.records.experiments(windows.start)
    states = problem.initial[experiment].copy()
    shown = sensed_states(problem.model)
    for i, state in enumerate(problem.model.states):
        if state.initial == "measured" or state.name in shown:
            measured = measured_at(problem.model, state, problem.records, windows.start)
            states[:, i] = np.where(np.isnan(measured), states[:, i], measured)
    states = hidden_starts(problem.model, problem.records, states, windows.start, windows.steps)
    return problem.model.begun(states, problem.driving_records, windows.start, problem.values)
