"""Start states of the experiments of many machines, each estimated on its first tenth, all together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.estimate.initial import FRACTION, START_SETTINGS, beginning, estimate_initial, from_short_windows
from greybox_torch.estimate.levenberg_marquardt import descending
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.together.answering import answered_together
from greybox_torch.estimate.together.free_runs import FreeRuns
from greybox_torch.simulation.simulator import Simulator


def estimate_initial_together(
    problems: Sequence[Problem], simulator: Simulator, substeps: Sequence[int]
) -> list[Problem]:
    """As :func:`greybox_torch.estimate.initial.estimate_initial` for each of some problems of one model, with so many sub-steps (M,)."""
    result = list(problems)
    parts: list[tuple[int, int]] = []
    begun: list[Problem] = []
    for m, problem in enumerate(problems):
        own = simulator.with_substeps(substeps[m])
        if problem.model.start_trials(problem.values):
            result[m] = estimate_initial(problem, own)
        elif problem.initial_free.any():
            for e in range(len(problem.records.first)):
                part = beginning(problem, e, FRACTION)
                short = replace(part, initial=from_short_windows(part, own))
                parts += [(m, e)] * 2
                begun += [part, short]
    if not begun:
        return result
    runs = FreeRuns(tuple(begun), simulator, tuple(substeps[m] for m, _ in parts))
    descents = {k: descending(run.start, *run.bounds, settings=START_SETTINGS) for k, run in enumerate(runs.runs)}
    best = dict.fromkeys(parts, np.inf)
    rows = {m: np.array(problems[m].initial) for m, _ in parts}
    ended = answered_together(runs, descents)
    for k, (m, e) in enumerate(parts):
        optimum = ended[k]
        if optimum is not None and optimum.model.cost < (1 - 1e-6) * best[m, e]:
            best[m, e] = optimum.model.cost
            rows[m][e] = runs.runs[k].at(optimum.point).initial[0]
    for m, initial in rows.items():
        result[m] = problems[m].with_values(problems[m].values, initial)
    return result


def well_begun_together(runs: FreeRuns, machines: Sequence[int]) -> list[tuple[Problem, float]]:
    """As :func:`greybox_torch.estimate.beginnings.well_begun` for each of some ``machines`` of ``runs``."""
    given, substeps = [runs.problems[m] for m in machines], tuple(runs.substeps[m] for m in machines)
    estimated = estimate_initial_together(given, runs.simulator, substeps)
    before, after = (_costs(FreeRuns(tuple(each), runs.simulator, substeps)) for each in (given, estimated))
    return [(other, b) if b < a else (one, a) for one, other, a, b in zip(given, estimated, before, after, strict=True)]


def _costs(runs: FreeRuns) -> list[float]:
    """The costs of whole records; infinite where the simulation overflows."""
    found = runs.quadratics({m: run.start for m, run in enumerate(runs.runs)})
    here = [found[m] for m in range(len(runs.runs))]
    return [float("inf") if each is None else each.cost for each in here]
