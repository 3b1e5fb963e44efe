"""What windows with free start states tell of the parameters."""

from __future__ import annotations

import numpy as np

from greybox_torch.estimate.window_fit import WindowFit, evaluate
from greybox_torch.linear_algebra import solve
from greybox_torch.simulation.simulator import Simulator


def window_information(fit: WindowFit, simulator: Simulator) -> np.ndarray | None:
    """The Gauss-Newton Hessian (n_p, n_p) of half the squared weighted error, by free parameters, window starts eliminated.

    None where the windows cannot be simulated.

    Args:
        simulator: with tangents for the free parameters.
    """
    here = evaluate(fit.problem, simulator, fit.windows, fit.starts)
    if here is None:
        return None
    return here.hpp - np.einsum("wsp,wsq->pq", here.hsp, solve(here.hss, here.hsp))
