"""Window start states from the free runs of a hypothesis.

A window's own measurements may not suggest where it begins: a position that nobody measures, a memory, a coarse sensor. A free run of the
whole experiment has it all, where it does not overflow.
"""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows, cut, whole_records


def along_free_runs(started: Problem, simulator: Simulator, length: int, budget: SearchBudget) -> WindowFit | None:
    """Windows begun where free runs pass, for models that overflow from what the measurements of a window alone suggest."""
    starts = free_run_states(started, simulator, cut(started.records, length))
    if starts is None:
        return None
    return fit_windows(started, simulator, length, starts=starts, settings=budget.position_iterations)


def free_run_states(started: Problem, simulator: Simulator, windows: Windows) -> np.ndarray | None:
    """States (W, n_x) of free runs of whole experiments where windows begin; None where one of them overflows."""
    records = started.records
    asked = Pass(whole_records(records), started.values, started.initial, keep_states=True)
    run = simulator.run(started.driving_records, asked)
    assert run.states is not None
    experiment = records.experiments(windows.start)
    states = run.states[experiment, windows.start - records.first[experiment]]
    return states if np.isfinite(states).all() else None
