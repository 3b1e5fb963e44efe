"""What an effect gains on experiments that had no part in choosing it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.diagnose.refit import WINDOW_SETTINGS, Hypothesis, lengths
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.estimate.window_fit import WindowFit, fit_windows


@dataclass(frozen=True)
class Gain:
    """The share of the held-out squared error that an effect removes, and its standard error over windows."""

    share: float
    error: float

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the share."""
        return self.share - 1.96 * self.error, self.share + 1.96 * self.error


def held_out_fits(hypothesis: Hypothesis, problem: Problem, substeps: int) -> tuple[WindowFit, ...]:
    """The hypothesis on other experiments: parameters as they are, window start states free, at the middle and the longest windows.

    Args:
        problem: the plain model on the held-out experiments.
    """
    own = hypothesis.values()
    known: Mapping[str, float] = {n: own[n] for n in hypothesis.problem.names}
    restated = (
        problem_for(problem, hypothesis.model, known)
        if hypothesis.effects
        else problem.with_values(hypothesis.problem.values)
    )
    fixed = replace(restated, free=np.zeros_like(restated.free))
    started = estimate_initial(fixed, hypothesis.stepper, substeps=substeps)
    found = []
    for length in lengths(problem)[1:] or lengths(problem):
        fit = fit_windows(started, hypothesis.stepper, length, substeps=substeps, settings=WINDOW_SETTINGS)
        if fit is not None:
            found.append(fit)
    return tuple(found)


def gain(before: tuple[WindowFit, ...], after: tuple[WindowFit, ...]) -> Gain:
    """What ``after`` removes of the error of ``before``, at the window length where that is surest.

    The standard error is that of the mean over windows of the difference in energy.
    """
    best = Gain(0.0, float("inf"))
    for old, new in zip(before, after, strict=False):
        if len(old.energies) != len(new.energies):
            continue
        difference, total = old.energies - new.energies, float(old.energies.sum())
        share = float(difference.sum()) / max(total, 1e-300)
        error = (
            float(np.std(difference, ddof=1)) * np.sqrt(len(difference)) / max(total, 1e-300)
            if len(difference) > 1
            else np.inf
        )
        if share / max(error, 1e-300) > best.share / best.error or not np.isfinite(best.error):
            best = Gain(share, error)
    return best
