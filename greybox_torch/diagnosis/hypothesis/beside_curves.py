"""The uncertainty of a hypothesis with free curves, their weights among the unknowns.

Whole records are fitted with these weights as the windows have them. Deviations that take them for known are those of a law that is
known. Seen: a conductance of 89.915 ± 0.019 W/K (90.0) beside a curve; ± 0.15 with its weights unknown. The same of bumps that were left
out: that they are zero is what was chosen, not what is known, and where a curve is held at zero, a parameter that does what a constant of
it does looks as if it were known. Seen: 1757.3 ± 2.6 W/K (1250), ± 400 with them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.estimate.coloured_run import ColouredRun, spectrum
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.uncertainty import Uncertainty, of_information, uncertainty
from greybox_torch.estimate.window_information import uncertainty_over_windows
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.simulator import Simulator


def beside_curves(hypothesis: Hypothesis, at: Problem, *, weighed: bool = False) -> tuple[Problem, Uncertainty] | None:
    """The problem ``at`` the optimum with the weights of free curves free, and the uncertainty of all its unknowns.

    None without free curves, and where the sensitivities to their weights are not finite.

    What is known of a height before is that it is hardly larger than the largest of its curve: where nothing was measured it is open.

    Args:
        weighed: whether errors are weighed by their spectrum.
    """
    if not weights_of_curves(hypothesis).any():
        return None
    problem, simulator, weights = with_whole_curves(hypothesis, at)
    run = FreeRun(problem, simulator)
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


def windows_beside_curves(hypothesis: Hypothesis, at: Problem) -> tuple[Problem, Uncertainty] | None:
    """The same of the longest windows with start states of their own, for the problem ``at`` their values; None where they cannot be
    simulated.
    """
    fit = hypothesis.fits[-1]
    problem, simulator, weights = with_whole_curves(hypothesis, fit.problem)
    found = uncertainty_over_windows(replace(fit, problem=problem), simulator, _known(problem, weights)[problem.free])
    return None if found is None else (with_whole_curves(hypothesis, at)[0], found)


def with_whole_curves(hypothesis: Hypothesis, at: Problem) -> tuple[Problem, Simulator, np.ndarray]:
    """The problem ``at`` values of it with all weights of free curves free, of bumps that were left out as well, which are zero; with its
    simulator, and which of its parameters are such weights.
    """
    weights = weights_of_curves(hypothesis)
    effects = [whole(effect) for effect in hypothesis.effects]
    if effects == list(hypothesis.effects):
        return replace(at, free=at.free | weights), hypothesis.simulator, weights
    model = hypothesis.model
    assert isinstance(model, AugmentedModel)
    more = AugmentedModel(model.base, effects, model.surroundings)
    named = dict(zip(at.names, zip(at.free | weights, at.lower, at.upper, at.expected, strict=True), strict=True))
    columns = [named.get(p.name, (p.shrunk and not p.fixed, *p.bounds, 0.0)) for p in more.declared_parameters]
    free, lower, upper, expected = (np.array(column) for column in zip(*columns, strict=True))
    problem = replace(
        at,
        model=more,
        names=tuple(p.name for p in more.declared_parameters),
        values=np.array([at.values_by_name.get(p.name, 0.0) for p in more.declared_parameters]),
        free=free.astype(bool),
        lower=lower,
        upper=upper,
        expected=expected,
    )
    new = np.array([p.shrunk for p in more.declared_parameters], dtype=bool) & problem.free
    return problem, hypothesis.simulator.for_model(more, problem.free_names), new


def whole(effect: Attachment) -> Attachment:
    """An effect with the bumps of its curve that were left out; itself where there are none."""
    mechanism = effect.mechanism
    if not isinstance(mechanism, Unknown) or not mechanism.left_out:
        return effect
    return replace(effect, mechanism=mechanism.altered(left_out=()))


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
