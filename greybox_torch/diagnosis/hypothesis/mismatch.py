"""How large the mismatch of a model is beside the motion itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known, mean_squared_step, noise_floor
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import Problem


def mismatch_share(fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """Root mean square error beyond the noise, in units of the outputs' spread: the largest over the window lengths."""
    known = floor_known(fitted.problem, settings)  # else what looks like noise may be motion, and hide what is missing
    shares = []
    for fit in fitted.fits:
        beyond = max(fit.mean_square - known * noise_floor(fit.problem, settings), 0.0)
        shares.append(np.sqrt(beyond / _mean_squared_spread(fit.problem)))
    return float(max(shares))


def least_mismatch(study: Study) -> float:
    """The mismatch, in the same unit, below which nothing is looked for: simulations of one machine differ by as much, or it is small and
    no more than a shift in time by a small part of the sampling interval.

    When within its interval a sample was taken, and when the input began to act, nobody knows better than that.
    """
    settings, problem = study.settings, study.problem
    recorded = problem if study.recorded is None else replace(problem, records=study.recorded)
    step = np.sqrt(mean_squared_step(recorded, settings) / _mean_squared_spread(recorded))
    return max(settings.least_mismatch, min(settings.least_shift * float(step), settings.most_of_shift))


def negligible(study: Study, fitted: Hypothesis) -> bool:
    """Whether a mismatch is below that."""
    return mismatch_share(fitted, study.settings) < least_mismatch(study)


def _mean_squared_spread(problem: Problem) -> float:
    spread = np.nanstd(problem.records.y, axis=1) * problem.weights
    return max(float(np.mean(spread**2)), 1e-300)
