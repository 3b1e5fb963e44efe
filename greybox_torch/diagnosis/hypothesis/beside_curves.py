"""The uncertainty of a hypothesis with free curves, their weights among the unknowns.

Whole records are fitted with these weights as the windows have them. Deviations that take them for known are those of a law that is
known. Seen: a conductance of 89.915 ± 0.019 W/K (90.0) beside a curve; ± 0.15 with its weights unknown.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.estimate.coloured_run import ColouredRun, spectrum
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.uncertainty import Uncertainty, of_information, uncertainty


def beside_curves(hypothesis: Hypothesis, at: Problem, *, weighed: bool = False) -> tuple[Problem, Uncertainty] | None:
    """The problem ``at`` the optimum with the weights of free curves free, and the uncertainty of all its unknowns.

    None without free curves, and where the sensitivities to their weights are not finite.

    What is known of a height before is that it is hardly larger than the largest of its curve: where nothing was measured it is open.

    Args:
        weighed: whether errors are weighed by their spectrum.
    """
    weights = weights_of_curves(hypothesis)
    if not weights.any():
        return None
    problem = replace(at, free=at.free | weights)
    run = FreeRun(problem, hypothesis.simulator)
    z, known = run.start, _known(problem, weights)
    stiff = np.concatenate([known[problem.free], np.zeros(len(run.start) - run.n_parameters)])
    if weighed:
        found = run.errors(z)
        here = None if found is None else ColouredRun(run, tuple(spectrum(e) for e, _ in found)).quadratic(z)
        return None if here is None else (problem, of_information(here.hessian + np.diag(stiff), by_samples=True))
    here = run.quadratic(z)
    if here is None or not np.isfinite(here.hessian).all():
        return None
    return problem, uncertainty(run, z, 2.0 * here.cost / problem.samples * stiff)


def weights_of_curves(hypothesis: Hypothesis) -> np.ndarray:
    """Which of the parameters (n_p,) are free weights of curves."""
    return np.array([p.shrunk for p in hypothesis.model.declared_parameters], dtype=bool) & hypothesis.problem.free


def _known(problem: Problem, weights: np.ndarray) -> np.ndarray:
    """By parameter (n_p,) the inverse square of the size that it is known to have: of every height that of the largest of its curve; zero
    elsewhere. A single weight beside a parameter that does the same would else leave both open.
    """
    of_effect = [name.rpartition(".")[0] for name in problem.names]
    known = np.zeros(len(problem.values))
    for effect in {name for name, own in zip(of_effect, weights, strict=True) if own}:
        own = weights & np.array([name == effect for name in of_effect])
        largest = float(np.abs(problem.values[own]).max())
        if largest > 0:
            known[own] = 1.0 / largest**2
    return known
