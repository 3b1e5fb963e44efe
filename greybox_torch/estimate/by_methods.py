"""How whole records are descended on: by one method after the other, logarithms of the parameters where the plain one creeps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Descending, Settings, descending
from greybox_torch.estimate.logarithmic import descending_on_logarithms
from greybox_torch.estimate.termination import Termination

PATIENCE = 60
"""Iterations after which a descent that has not arrived is taken to creep."""

CREEPING = 1e-6
"""Relative change of the cost from which an iteration on logarithms leads on; what follows ends the descent."""

Method = Callable[..., Descending[None]]

METHODS: tuple[Method, ...] = (descending, descending_on_logarithms, descending)
"""How whole records are descended on, one after the other."""

BETTER_BEGUN = METHODS[1:]
"""From start values that were looked for."""

Report = Callable[[int, float, float], None]
"""Called with an iteration of a descent, the cost there, and the step."""


def by_methods(
    run: FreeRun,
    settings: Settings,
    methods: Sequence[Method],
    report: Report | None = None,
) -> Descending[None]:
    """The questions of a descent by one method after the other, until the plain one has arrived; its optimum counts the passes of all."""
    z, iterations, evaluations, optimum = run.start, 0, 0, None
    for method in methods:
        limited = replace(settings, iterations=min(PATIENCE, settings.iterations - iterations))
        if method is descending_on_logarithms:
            limited = replace(limited, tolerance=max(CREEPING, settings.tolerance))
        if limited.iterations <= 0:
            break
        here = yield from method(z, *run.bounds, settings=limited, on_iteration=_counted_on(report, iterations))
        if here is None:
            return None
        z, iterations, evaluations = here.point, iterations + here.iterations, evaluations + here.evaluations
        optimum = replace(here, iterations=iterations, evaluations=evaluations)
        if method is descending and here.termination is not Termination.iteration_limit:
            break
    return optimum


def _counted_on(report: Report | None, before: int) -> Report | None:
    """The next method's iterations, counted on from those ``before``: seen was a log that began anew every twenty."""
    return report if report is None else lambda i, cost, step: report(before + i, cost, step)
