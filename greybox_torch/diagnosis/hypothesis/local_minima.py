"""Local minima that the fits over windows of several lengths show one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.window_fit import WindowFit, fit_windows, states_along
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import cut

CLEARLY = 1.02
"""Ratio of mean squared errors from which one is larger by more than what the ends of descents differ by."""


def no_worse_than_longer(
    fits: Sequence[WindowFit], lengths: Sequence[int], simulator: Simulator, limits: Settings
) -> list[WindowFit]:
    """Fits, shortest windows first; those that are worse than the fit over longer windows begun again from where that one led.

    With the same parameters, start states that are free more often only lower the error: a fit over short windows that is worse than one
    over longer windows has ended in a local minimum.

    Args:
        lengths: of the windows, one a fit.
    """
    found = list(fits)
    for k in reversed(range(len(found) - 1)):
        own, longer = found[k], found[k + 1]
        if own.mean_square <= CLEARLY * longer.mean_square:
            continue
        starts = states_along(longer, simulator)[cut(own.problem.records, lengths[k]).start]
        problem = replace(own.problem, values=longer.problem.values, initial=longer.problem.initial)
        again = fit_windows(problem, simulator, lengths[k], starts=starts, settings=limits)
        if again is not None and again.mean_square < own.mean_square:
            found[k] = again
    return found
