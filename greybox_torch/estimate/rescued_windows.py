"""Windows that ended in another valley than their neighbours, begun once more where the window before ends.

A state that no sensor shows begins in every window at a guess. From a poor one (a tank that is thought empty has no outflow to tell that
it is not) a window may not find back, and its error then outweighs all the others. With the parameters as they are, windows are
independent, so each can take whichever start fits it best.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.rough_starts import rough_starts
from greybox_torch.estimate.window_fit import WindowFit, fit_windows, states_along
from greybox_torch.simulation.stepper import Stepper

OUTLYING = 10.0
"""Times the median energy from which a window is begun once more."""

GLANCE = Settings(iterations=12, tolerance=1e-3, trials=5)
"""How far the start states are followed with the parameters as they are."""


def rescued(fit: WindowFit, stepper: Stepper, length: int, substeps: int) -> WindowFit:
    """``fit`` with the start states of outlying windows replaced by better ones, parameters as they are; itself where there are none."""
    outlying = fit.energies > OUTLYING * np.median(fit.energies)
    if not outlying.any() or fit.problem.carried.all():
        return fit
    fixed = replace(fit.problem, free=np.zeros_like(fit.problem.free))
    best = fit
    for starts in _other_starts(fit, stepper, substeps):
        begun = np.where(outlying[:, None], starts, fit.starts)
        again = fit_windows(fixed, stepper, length, starts=begun, substeps=substeps, settings=GLANCE)
        if again is not None:
            best = window_by_window(best, again)
    return replace(best, problem=fit.problem) if best is not fit else fit


def window_by_window(one: WindowFit, other: WindowFit) -> WindowFit:
    """Of two fits of the start states, parameters alike, the better one in every window."""
    better = other.energies < one.energies
    if not better.any():
        return one
    energies = np.where(better, other.energies, one.energies)
    share = float(energies.sum()) / max(float(one.energies.sum()), 1e-300)
    starts = np.where(better[:, None], other.starts, one.starts)
    return replace(one, starts=starts, energies=energies, mean_square=share * one.mean_square)


def _other_starts(fit: WindowFit, stepper: Stepper, substeps: int) -> list[np.ndarray]:
    """Start states (W, n_x): where the window before ends, the measured ones as measured and as they end."""
    windows, states = fit.windows, states_along(fit, stepper, substeps)
    before = np.maximum(windows.start - 1, 0)
    first = np.isin(windows.start, fit.problem.records.first)
    ended = np.where(first[:, None] | ~np.isfinite(states[before]), fit.starts, states[before])
    measured = np.array([s.initial == "measured" for s in fit.problem.model.states])
    shown = np.isin([s.name for s in fit.problem.model.states], [o.name for o in fit.problem.model.outputs]) | measured
    return [np.where(shown, rough_starts(fit.problem, windows), ended), ended]
