"""As many Runge-Kutta steps per sample for whole records as what was found needs there.

Over windows a step that is too long is taken up by their start states. In a free run its error adds up: parameters would bend to it, and
what is left would be error of the integration. Seen: a winch whose dry friction changes its sign within 0.02 rad/s, told as 0.026 with a
deviation of 0.0002; its free run was left at 5 times the noise, "look for a load", and in four steps at noise alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.free_run import simulate
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.estimate.through_windows import from_windows
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.simulation.simulator import Simulator


def in_steps_for_whole_records(hypothesis: Hypothesis, settings: DiagnosisSettings) -> Hypothesis:
    """A hypothesis with its newest effect in as many steps per sample as its free runs ask for, where those change a part of the error
    that counts (``settings.part_of_steps``); else as it is, as every pass takes as many times as long.
    """
    if not hypothesis.effects or not isinstance(hypothesis.model, AugmentedModel):
        return hypothesis
    problem, simulator = from_windows(hypothesis.fits[-1]), hypothesis.simulator
    asked = fine_enough(simulator, problem)
    if asked.substeps <= simulator.substeps or not _changes(problem, simulator, asked, settings.part_of_steps):
        return hypothesis
    *others, newest = hypothesis.effects
    effects = (*others, replace(newest, substeps=asked.substeps))
    model = AugmentedModel(hypothesis.model.base, effects, hypothesis.model.surroundings)
    fits = tuple(replace(f, problem=replace(f.problem, model=model)) for f in hypothesis.fits)
    finer = simulator.for_model(model, hypothesis.problem.free_names)
    return replace(hypothesis, effects=effects, model=model, simulator=finer, fits=fits)


def _changes(problem: Problem, coarse: Simulator, fine: Simulator, part: float) -> bool:
    """Whether finer steps move the free runs by at least that part of their error, root mean square over all that is measured."""
    apart, errors = [], []
    for experiment, (before, after) in enumerate(zip(simulate(problem, coarse), simulate(problem, fine), strict=True)):
        measured = problem.records.y[:, problem.records.span(experiment)].T
        known = np.isfinite(measured)
        apart.append((problem.weights * (after - before))[known])
        errors.append((problem.weights * (after - np.where(known, measured, 0.0)))[known])
    moved, left = (float(np.sqrt(np.mean(np.concatenate(some) ** 2))) for some in (apart, errors))
    return bool(np.isfinite(left) and not moved < part * left)
