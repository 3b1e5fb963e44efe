"""Where a descent on whole records may begin: how start values simulate, and with which start states they do so best.

Start states that nothing has estimated yet (a height that a model file puts at zero) can make the best parameter values look as if they did
not simulate at all. So parameter values are judged by start states that were estimated for them, as where models are compared.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.metrics import fit_percent
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.simulator import Simulator

TOLERABLE = 30.0
"""Fit in % from which a simulation is a place to begin a descent on whole records."""


def tolerable(fits: np.ndarray) -> bool:
    """Whether start values that simulate with ``fits`` in % are a place to begin a descent on whole records."""
    return bool(fits.min() > TOLERABLE)


def fits_of(problem: Problem, simulated: Sequence[np.ndarray]) -> np.ndarray:
    """Fit in % of every output of every experiment, simulated (N_e, n_y)."""
    return np.array(
        [
            fit_percent(problem.records.y[k, problem.records.span(e)], run[:, k])
            for e, run in enumerate(simulated)
            for k in range(run.shape[1])
        ]
    )


def cost_of(problem: Problem, simulator: Simulator) -> float:
    """The cost of whole records; infinite where the simulation overflows."""
    run = FreeRun(problem, simulator)
    here = run.quadratic(run.start)
    return float("inf") if here is None else here.cost


def well_begun(problem: Problem, simulator: Simulator) -> tuple[Problem, float]:
    """The parameter values of ``problem`` with the better of two: its start states, or those estimated on the first tenth; and the cost."""
    given = problem, cost_of(problem, simulator)
    if not problem.initial_free.any():
        return given
    estimated = estimate_initial(problem, simulator)
    cost = cost_of(estimated, simulator)
    return (estimated, cost) if cost < given[1] else given
