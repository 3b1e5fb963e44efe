"""The way of many machines from start values to an optimum of whole records, their passes together.

Each makes the iterations that it makes alone. What a machine needs beyond a descent on whole records (short windows where its start
values do not simulate, other start values where these were poor) it does by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from greybox_torch.estimate.beginnings import fits_of, tolerable
from greybox_torch.estimate.by_methods import METHODS, by_methods
from greybox_torch.estimate.descent import (
    FINER,
    Descent,
    DescentOptions,
    descend,
    improved,
    no_worse,
    or_elsewhere,
)
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.together.answering import answered_together
from greybox_torch.estimate.together.free_runs import FreeRuns, alike, whole
from greybox_torch.estimate.together.initial import well_begun_together
from greybox_torch.estimate.together.substeps import with_fine_steps

Told = Callable[[str], None]


def descend_nested_together(
    problems: Sequence[Problem], options: DescentOptions, starts: int | None, told: Told
) -> list[Descent | None]:
    """As :func:`greybox_torch.estimate.nested.descend_nested` for each of some problems of one model."""
    found = descend_together(problems, options, starts, told)
    zeros = [p.free & (p.values == 0.0) for p in problems]
    nested = [m for m, zero in enumerate(zeros) if zero.any() and zero.sum() < problems[m].free.sum()]
    simpler = [replace(problems[m], free=problems[m].free & ~zeros[m]) for m in nested]
    for m, there in zip(nested, descend_together(simpler, options, starts, told), strict=True):
        if there is not None and _cost(there) < _cost(found[m]):
            optimum = there.run.at(there.optimum.point)
            begin = problems[m].with_values(optimum.values, optimum.initial)
            found[m] = improved(found[m], begin, _own(options, begin))
    return found


def descend_together(
    problems: Sequence[Problem], options: DescentOptions, starts: int | None, told: Told
) -> list[Descent | None]:
    """As :func:`greybox_torch.estimate.descent.descend` for each of some problems of one model."""
    result: list[Descent | None] = [None] * len(problems)
    for group in alike(problems):
        own = _own(options, problems[group[0]])
        runs = with_fine_steps([problems[m] for m in group], own.simulator)
        simulated = runs.simulated(range(len(group)))
        fits = [fits_of(p, whole(p, simulated[k])) for k, p in enumerate(runs.problems)]
        begun = [k for k, fit in enumerate(fits) if tolerable(fit)]
        told(
            f"{len(begun)} machines together"
            + (f", {len(group) - len(begun)} alone" if len(begun) < len(group) else "")
        )
        found = _whole_records(runs, begun, own)
        well_begun = dict(zip(begun, well_begun_together(runs, begun), strict=True))
        for k, m in enumerate(group):
            if k in found:
                no_worse_found = no_worse(found[k], *well_begun[k], own)
                result[m] = or_elsewhere(problems[m], fits[k], no_worse_found, own, starts)
            else:
                result[m] = descend(problems[m], own, starts)
    return result


def _own(options: DescentOptions, problem: Problem) -> DescentOptions:
    """``options`` with tangents for the free parameters of ``problem``."""
    return replace(options, simulator=options.simulator.for_model(problem.model, problem.free_names))


def _whole_records(runs: FreeRuns, machines: Sequence[int], options: DescentOptions) -> dict[int, Descent | None]:
    """The optima of whole records near the values of ``machines``, found anew with finer steps where they have come to need these."""
    begun = {m: by_methods(runs.runs[m], options.settings, METHODS) for m in machines}
    found = _descents(runs, begun, {})
    for _ in range(FINER):
        there = {m: d.run.at(d.optimum.point) for m, d in found.items() if d is not None}
        if not there:
            break
        finer = dict(zip(there, with_fine_steps(list(there.values()), runs.simulator).substeps, strict=True))
        again = [m for m, substeps in finer.items() if substeps > runs.substeps[m]]
        if not again:
            break
        problems = tuple(there.get(m, problem) for m, problem in enumerate(runs.problems))
        runs = FreeRuns(problems, runs.simulator, tuple(finer.get(m, s) for m, s in enumerate(runs.substeps)))
        begun = {m: by_methods(runs.runs[m], options.settings, METHODS[-1:]) for m in again}
        found |= _descents(runs, begun, found)
    return found


def _descents(runs: FreeRuns, begun: dict, before: dict[int, Descent | None]) -> dict[int, Descent | None]:
    """The optima that descents lead to, with the passes that it took to come to where they began."""
    result: dict[int, Descent | None] = {}
    for m, optimum in answered_together(runs, begun).items():
        earlier = before.get(m)
        passes = 0 if earlier is None else earlier.evaluations
        result[m] = None if optimum is None else Descent(runs.runs[m], optimum, passes + optimum.evaluations)
    return result


def _cost(found: Descent | None) -> float:
    return float("inf") if found is None else float(found.optimum.model.cost)
