"""What windows with free start states tell of the parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.estimate.uncertainty import Uncertainty, of_information
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


def uncertainty_over_windows(
    fit: WindowFit,
    simulator: Simulator,
    known: np.ndarray | None = None,
    names: Sequence[str] | None = None,
) -> Uncertainty | None:
    """Of the free parameters, start states of the windows eliminated; errors as white as they are. None where nothing is free, and where
    the windows cannot be simulated.

    Args:
        known: what is known of the free parameters before (n_p,), as inverse variances about their values; by default nothing.
        names: the free parameters that are asked for, in this order, the others taken as known; by default all.
    """
    information = window_information(fit, simulator)
    if information is None or not len(information):
        return None
    unknowns = len(information) + fit.starts.size
    variance = float(fit.energies.sum()) / max(fit.problem.samples - unknowns, 1)
    before = 0.0 if known is None else np.diag(known)
    asked = fit.problem.free_names if names is None else names
    index = [fit.problem.free_names.index(name) for name in asked]
    if not index:
        return None
    found = information / max(variance, np.finfo(float).tiny) + before
    return of_information(found[np.ix_(index, index)])
