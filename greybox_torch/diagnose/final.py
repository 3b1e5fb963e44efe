"""The final fits: whole records, from the values that the windows led to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from greybox_torch.diagnose.refit import Hypothesis
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Optimum, Settings, minimise
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.uncertainty import Uncertainty, uncertainty
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulate.side_by_side import side_by_side
from greybox_torch.simulate.stepper import Stepper, make_stepper

SETTINGS = Settings(iterations=60, tolerance=1e-8)
BEGINNING = Settings(iterations=12, tolerance=1e-3)
"""How far the values of every window length are followed before the best of them goes on to the end."""


@dataclass(frozen=True)
class Final:
    """A hypothesis fitted to whole estimation records: its problem there, and the uncertainty of the unknowns (None where unfitted)."""

    problem: Problem
    uncertainty: Uncertainty | None

    def values(self) -> dict[str, float]:
        """Parameter values by name."""
        return dict(zip(self.problem.names, map(float, self.problem.values), strict=True))

    def deviations(self) -> dict[str, float]:
        """Standard deviation of every free parameter: the larger of the plain and the sandwich one."""
        if self.uncertainty is None:
            return {}
        both = np.maximum(self.uncertainty.deviations("plain"), self.uncertainty.deviations("sandwich"))
        return dict(zip(self.problem.free_names, map(float, both), strict=False))


def finish(hypothesis: Hypothesis, substeps: int, *, device: str = "cpu") -> Final:
    """Fit whole records by simulation error, from the values of every window length and from the card's; the best of the results.

    Where no whole record can be simulated, the values of the longest windows stand. The heights of free curves stay as the windows have
    them, where they are held small: what the records do not determine must not run away.
    """
    model = hypothesis.model
    shrunk = [p.name for p in model.declared_parameters if p.shrunk]
    stepper = hypothesis.stepper
    if shrunk:
        stepper = make_stepper(model, [n for n in hypothesis.problem.free_names if n not in shrunk], device=device)
    runs = [_free_run(_from_windows(fit), shrunk, stepper, substeps) for fit in reversed(hypothesis.fits)]
    runs.append(_free_run(_from_the_card(hypothesis), shrunk, stepper, substeps))
    begun = side_by_side(partial(_descended, run, run.start, BEGINNING) for run in runs)
    best, cost = None, np.inf
    for run, optimum in zip(runs, begun, strict=True):
        if optimum is not None and optimum.model.cost < (1 - 1e-3) * cost:
            best, cost = (run, optimum.point), optimum.model.cost
    if best is None:
        return Final(_from_windows(hypothesis.fits[-1]), None)
    run, point = best
    ended = _descended(run, point, SETTINGS)
    point = point if ended is None else ended.point
    return Final(run.at(point), uncertainty(run, point))


def _free_run(problem: Problem, kept: list[str], stepper: Stepper, substeps: int) -> FreeRun:
    return FreeRun(replace(problem, free=problem.free & ~np.isin(problem.names, kept)), stepper, substeps)


def _descended(run: FreeRun, start: np.ndarray, settings: Settings) -> Optimum[None] | None:
    return minimise(run.quadratic, start, *run.bounds, settings=settings, admissible=run.admissible)


def _from_windows(fit: WindowFit) -> Problem:
    """The problem with the start states of the windows that begin an experiment, where those are free."""
    problem = fit.problem
    initial = problem.initial.copy()
    index = np.searchsorted(fit.windows.start, problem.tape.first)
    free = problem.initial_free
    initial[:, free] = fit.starts[index][:, free]
    return replace(problem, initial=initial)


def _from_the_card(hypothesis: Hypothesis) -> Problem:
    """The problem of the longest windows with the machine's own parameters as the card has them: windows may lead to another valley."""
    problem = _from_windows(hypothesis.fits[-1])
    added = [any(name.startswith(f"{e.prefix}.") for e in hypothesis.effects) for name in problem.names]
    return problem.with_values(np.where(added, problem.values, problem.expected))
