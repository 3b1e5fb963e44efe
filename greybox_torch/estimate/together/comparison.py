"""Free runs of many machines against their measurements, with the start values and with the estimates."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.data import Recording
from greybox_torch.estimate.comparison import Comparison, compared
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.together.free_runs import FreeRuns, alike, whole
from greybox_torch.estimate.together.initial import estimate_initial_together
from greybox_torch.simulation.simulator import Simulator


def compare_together(
    problems: Sequence[Problem],
    recordings: Sequence[Sequence[Recording]],
    simulator: Simulator,
    substeps: Sequence[int],
    *,
    estimate_starts: bool = True,
) -> list[Comparison]:
    """As :func:`greybox_torch.estimate.comparison.compare` for each of some problems of one model, with so many sub-steps (M,)."""
    result: dict[int, Comparison] = {}
    for group in alike(problems):
        own, steps = [problems[m] for m in group], [substeps[m] for m in group]
        if estimate_starts:
            own = estimate_initial_together(own, simulator, steps)
        simulated = FreeRuns(tuple(own), simulator, tuple(steps)).simulated(range(len(own)))
        for k, m in enumerate(group):
            result[m] = compared(own[k], recordings[m], whole(own[k], simulated[k]))
    return [result[m] for m in range(len(problems))]
