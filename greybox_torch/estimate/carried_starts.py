"""Start states of windows that are carried from each window into the next."""

from __future__ import annotations

import numpy as np

from greybox_torch.estimate.integrated_speeds import integrated_speeds
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.passes import Pass, Restarts
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows


def carried_starts(problem: Problem, simulator: Simulator, windows: Windows, starts: np.ndarray) -> np.ndarray:
    """``starts`` (W, n_x) with the carried states brought along each experiment: simulated, or the integral of a measured speed.

    Args:
        windows: as :func:`cut` makes them.
    """
    records = problem.records
    experiment = records.experiments(windows.start)
    chains = [np.flatnonzero(experiment == e) for e in range(len(records.first))]
    most = max(len(c) for c in chains)
    if most == 1 or not problem.carried.any():
        return starts
    result, simulated, first = starts.copy(), problem.carried.copy(), np.searchsorted(experiment, experiment)
    for i, way in integrated_speeds(problem, windows.start).items():
        result[:, i], simulated[i] = starts[first, i] + way, False
    if not simulated.any():
        return result
    longest = next(c for c in chains if len(c) == most)
    every = int(windows.start[longest[1]] - windows.start[longest[0]])
    of_chain = np.array([c[np.minimum(np.arange(most), len(c) - 1)] for c in chains])
    begin = Windows(windows.start[of_chain[:, 0]], records.last, every * (most - 1) + 1)
    restarts = Restarts(every, problem.carried, starts[of_chain])
    run = simulator.run(problem.driving_records, Pass(begin, problem.values, starts[of_chain[:, 0]], restarts=restarts))
    assert run.begun is not None
    for chain, begun in zip(chains, run.begun, strict=True):
        result[np.ix_(chain[1:], simulated)] = np.nan_to_num(begun[1 : len(chain)][:, simulated])
    return result
