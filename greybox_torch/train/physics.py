"""The physics alone, as well as it can be estimated: what the hybrid has to beat, and where it begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.errors import NumericalError
from greybox_torch.estimate.fit import FitResult, fit
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulate.stepper import Stepper
from greybox_torch.simulate.substeps import choose_substeps

SETTINGS = Settings(iterations=25, tolerance=1e-3, trials=6)


@dataclass(frozen=True)
class Physics:
    """``result`` on whole records, and ``values`` (n_p,) from the shortest windows: a free run is drawn to parameters that bend the
    curve where physics is missing, short windows hardly are, and so the hybrid begins with these.
    """

    result: FitResult
    values: np.ndarray


def estimate_physics(problem: Problem, stepper: Stepper, lengths: Sequence[int], seed: int = 0) -> Physics:
    """The plain model estimated by way of windows of rising ``lengths``, and from its start values directly; the better of the two.

    Raises:
        NumericalError: the simulation overflows either way.
    """
    substeps = choose_substeps(problem.driving_tape, stepper, problem.values, problem.initial) or 1
    chain = windows_in_turn(problem, stepper, lengths, substeps, None)
    found = []
    if chain:
        found.append(_fitted(on_whole_records(chain[-1], problem), stepper, seed))
    try:
        found.append(_fitted(problem, stepper, seed))
    except NumericalError:
        if not found:
            raise
    best = min(found, key=lambda f: f.mse)
    return Physics(best, chain[0].problem.values if chain else best.problem.values)


def windows_in_turn(
    problem: Problem,
    stepper: Stepper,
    lengths: Sequence[int],
    substeps: int,
    size: float | None,
    settings: Settings = SETTINGS,
) -> list[WindowFit]:
    """Fits over windows of rising lengths, each begun with the parameters and start states of the one before.

    Args:
        size: of the shrunk parameters, see :func:`fit_windows`.
    """
    found: list[WindowFit] = []
    for length in lengths:
        before = found[-1] if found else None
        begun = problem if before is None else problem.with_values(before.problem.values)
        fitted = fit_windows(begun, stepper, length, shorter=before, substeps=substeps, settings=settings, size=size)
        if fitted is None:
            break
        found.append(fitted)
    return found


def on_whole_records(windows: WindowFit, problem: Problem) -> Problem:
    """``problem`` with the parameters of a window fit, its experiments beginning as their first windows do."""
    first = np.searchsorted(windows.windows.start, problem.tape.first)
    initial = np.where(problem.initial_free, windows.starts[first], problem.initial)
    return problem.with_values(windows.problem.values, initial)


def _fitted(problem: Problem, stepper: Stepper, seed: int) -> FitResult:
    return fit(problem, stepper=stepper, seed=seed, starts=1)


def with_physics(problem: Problem, physics: np.ndarray) -> Problem:
    """A hybrid's ``problem`` with the values (n,) of its first n parameters, those of the physics."""
    return replace(problem, values=np.concatenate([physics, problem.values[len(physics) :]]))
