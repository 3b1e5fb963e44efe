"""Estimating the free parameters and start states of many machines of one model, all together."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from greybox_torch.errors import NumericalError
from greybox_torch.estimate.descent import Descent, DescentOptions
from greybox_torch.estimate.fit import Estimation, estimation_of
from greybox_torch.estimate.identifiability import Unidentifiable, identifiability
from greybox_torch.estimate.overflow import overflow_error
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.together.descent import descend_nested_together
from greybox_torch.estimate.together.free_runs import alike
from greybox_torch.estimate.together.substeps import with_fine_steps
from greybox_torch.simulation.simulator import Simulator


def fit_together(
    problems: Sequence[Problem], options: DescentOptions, starts: int | None, told: Callable[[str], None]
) -> list[Estimation | NumericalError]:
    """As :func:`greybox_torch.estimate.fit.fit_records` for each of some problems of one model; the error where one fails."""
    found = descend_nested_together(problems, options, starts, told)
    return [_estimated(problem, descent, options) for problem, descent in zip(problems, found, strict=True)]


def _estimated(problem: Problem, found: Descent | None, options: DescentOptions) -> Estimation | NumericalError:
    if found is None:
        return overflow_error("estimating", problem, options.fine_enough(problem))
    unidentifiable = identifiability(found.run, found.optimum.point, found.optimum.model)
    return estimation_of(found, problem.samples, True, unidentifiable)


def undetermined_at_start(problems: Sequence[Problem], simulator: Simulator) -> list[tuple[Unidentifiable, ...]]:
    """What the data of every machine do not determine, as far as its start values tell."""
    result: dict[int, tuple[Unidentifiable, ...]] = {}
    for group in alike(problems):
        of_these = simulator.for_model(problems[group[0]].model, problems[group[0]].free_names)
        runs = with_fine_steps([problems[m] for m in group], of_these)
        here = runs.quadratics({k: run.start for k, run in enumerate(runs.runs)})
        for k, m in enumerate(group):
            result[m] = () if here[k] is None else identifiability(runs.runs[k], runs.runs[k].start, here[k])
    return [result[m] for m in range(len(problems))]
