"""How many Runge-Kutta steps a sample needs, machine by machine."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.together.free_runs import FreeRuns
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.substeps import LARGEST, TOLERANCE, all_finite, fine_enough, judged_steps, output_spread


def with_fine_steps(problems: Sequence[Problem], simulator: Simulator) -> FreeRuns:
    """The free runs of machines with as many sub-steps as each needs at its values; one where none give finite numbers.

    Each gets what :func:`greybox_torch.simulation.substeps.choose_substeps` gives it alone.
    """
    count = len(problems)
    runs = FreeRuns(tuple(problems), simulator, (1,) * count)
    steps = {m: judged_steps(p.records) for m, p in enumerate(problems)}
    limits, lengths = [TOLERANCE * output_spread(p.records) for p in problems], [p.records.lengths for p in problems]
    chosen, open_ones = np.ones(count, dtype=int), list(range(count))
    coarse = runs.simulated(open_ones, steps=steps)
    for substeps in (2**k for k in range(LARGEST.bit_length())):
        fine = runs.with_substeps((2 * substeps,) * count).simulated(open_ones, steps=steps)
        chosen[open_ones] = substeps
        open_ones = [m for m in open_ones if not fine_enough(coarse[m], fine[m], limits[m], lengths[m])]
        if not open_ones:
            break
        coarse = fine
    for m in open_ones:
        chosen[m] = LARGEST if all_finite(coarse[m], lengths[m]) else 1
    return runs.with_substeps([int(s) for s in chosen])
