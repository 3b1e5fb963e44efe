"""A richer model begins at the optimum of the simpler one that it holds.

A parameter that starts at zero is usually the amplitude of something added to a model that was there before. Estimated all at once from
poor start values, its descent may end in another valley than the simpler model's, and worse than that. The simpler model is the same one
with these parameters held where they start; from its optimum a descent can only gain.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import count

import numpy as np

from greybox_torch.estimate.descent import Descent, DescentOptions, descend, improved
from greybox_torch.estimate.problem import Problem

HELD = "with {} held at zero"
"""What the stage is called, for those whom the progress is told."""


def descend_nested(problem: Problem, options: DescentOptions, starts: int | None) -> Descent | None:
    """The best of a descent from the start values and one by way of the simpler model; as :func:`descend` where nothing starts at zero.

    It never ends worse than the simpler model estimated in the same way; a search of that for other valleys is given up where it is clearly
    behind what was found.
    """
    options = replace(options, numbers=count(1))
    found = descend(problem, options, starts)
    zero = problem.free & (problem.values == 0.0)
    if not zero.any() or zero.sum() == problem.free.sum():
        return found
    simpler = replace(problem, free=problem.free & ~zero)
    names = ", ".join(name for name, is_zero in zip(problem.names, zero, strict=True) if is_zero)
    of_it = replace(_told(options, simpler, HELD.format(names)), to_beat=2 * _cost(found) / problem.samples)
    there = descend(simpler, of_it, starts)
    if there is None or _cost(there) >= _cost(found):
        return found
    begin = problem.with_values(*_optimum(there))
    return improved(found, begin, options)


def _told(options: DescentOptions, simpler: Problem, what: str) -> DescentOptions:
    """``options`` for the simpler problem, which has fewer tangents; progress says what it is of."""
    told = options.progress
    progress: Callable[[str, int, float], None] | None = None
    if told is not None:
        progress = lambda stage, k, error: told(f"{what}: {stage}", k, error)  # noqa: E731
    simulator = options.simulator.for_model(simpler.model, simpler.free_names)
    return replace(options, simulator=simulator, progress=progress)


def _optimum(found: Descent) -> tuple[np.ndarray, np.ndarray]:
    problem = found.run.at(found.optimum.point)
    return problem.values, problem.initial


def _cost(found: Descent | None) -> float:
    return float("inf") if found is None else float(found.optimum.model.cost)
