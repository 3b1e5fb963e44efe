"""Start states of an experiment, estimated on its first tenth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Settings, minimise
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulate.stepper import Stepper
from greybox_torch.simulate.tape import Tape


def estimate_initial(problem: Problem, stepper: Stepper, *, fraction: float = 0.1, substeps: int = 1) -> Problem:
    """The problem with the free start states of every experiment estimated on its first ``fraction``, parameters as they are.

    Where the simulation fails from the start states given, they are left as they are.
    """
    if not problem.initial_free.any():
        return problem
    rows = []
    for e in range(len(problem.tape.first)):
        part = replace(
            problem,
            tape=_beginning(problem.tape, e, fraction),
            initial=problem.initial[e : e + 1],
            free=np.zeros_like(problem.free),
        )
        run = FreeRun(part, _AllFixed(stepper), substeps)
        optimum = minimise(run.quadratic, run.start, *run.bounds, settings=Settings(iterations=30, tolerance=1e-8))
        rows.append(part.initial[0] if optimum is None else run.at(optimum.point).initial[0])
    return problem.with_values(problem.values, np.array(rows))


class _AllFixed:
    """A stepper whose parameter tangents are left out: only start states vary."""

    def __init__(self, stepper: Stepper) -> None:
        self._stepper = stepper
        self.sensitive: tuple[str, ...] = ()

    def run(self, *args, tangents: bool = False, **options):
        return self._stepper.run(*args, tangents=False, **options)


def _beginning(tape: Tape, experiment: int, fraction: float) -> Tape:
    span = tape.span(experiment)
    length = max(10, int(np.ceil(fraction * (span.stop - span.start))))
    part = slice(span.start, min(span.start + length, span.stop))
    size = part.stop - part.start
    return Tape(
        tape.u[:, part],
        tape.y[:, part],
        tape.dt[part],
        np.array([0]),
        np.array([size - 1]),
        (tape.names[experiment],),
        tape.hold,
    )
