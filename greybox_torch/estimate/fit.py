"""Estimating the free parameters and start states of a model from recordings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.correlation import CorrelationMatrix, correlation_matrix
from greybox_torch.estimate.free_run import FreeRun, simulate
from greybox_torch.estimate.identifiability import Weakness, identifiability
from greybox_torch.estimate.levenberg_marquardt import DEFAULT, Optimum, Settings, minimise
from greybox_torch.estimate.metrics import fit_percent
from greybox_torch.estimate.notes import notes
from greybox_torch.estimate.overflow import overflow_error
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.termination import Outcome, Termination
from greybox_torch.estimate.uncertainty import Uncertainty, uncertainty
from greybox_torch.estimate.window_fit import fit_windows
from greybox_torch.simulate.stepper import Stepper, make_stepper
from greybox_torch.simulate.substeps import choose_substeps

GOOD_START = 30.0
"""Fit in % from which start values are trusted to lie in the right valley, so that the whole records are fitted at once."""

WINDOW_SHARES = (1 / 64, 1 / 16)
"""Window lengths, as shares of the longest record, that poor start values are led through."""


@dataclass(frozen=True)
class FitResult:
    """An estimate: the problem at its optimum and what is known about it.

    ``mse`` is the mean squared weighted error; ``fpe`` Akaike's final prediction error with d counting free parameters and free start
    states; ``uncertainty`` covers the unknowns in the order free parameters, then start states experiment by experiment.
    ``identifiability`` says what the data do not determine at the optimum, ``notes`` what is to be known beside its ``termination``.
    """

    problem: Problem
    mse: float
    fpe: float
    samples: int
    iterations: int
    evaluations: int
    termination: Termination
    uncertainty: Uncertainty | None
    substeps: int
    identifiability: tuple[Weakness, ...] = ()
    notes: tuple[Outcome, ...] = ()

    @property
    def correlation(self) -> CorrelationMatrix | None:
        """Correlations of the free parameters' estimates."""
        return None if self.uncertainty is None else correlation_matrix(self.problem.free_names, self.uncertainty)

    def parameter_deviations(self, kind: str = "plain") -> dict[str, float]:
        """Standard deviation of every free parameter, infinite where the data do not determine it."""
        if self.uncertainty is None:
            return {}
        values = self.uncertainty.deviations(kind)
        lost = {name for weakness in self.identifiability if weakness.undetermined for name in weakness.parameters}
        named = zip(self.problem.free_names, map(float, values), strict=False)
        return {name: float("inf") if name in lost else value for name, value in named}

    def initial_deviations(self, kind: str = "plain") -> np.ndarray:
        """Standard deviations (E, n_x) of the start states, zero where fixed."""
        result = np.zeros_like(self.problem.initial)
        if self.uncertainty is not None:
            own = self.uncertainty.deviations(kind)[len(self.problem.free_names) :]
            result[:, self.problem.initial_free] = own.reshape(len(result), -1)
        return result


Progress = Callable[[str, int, float], None]
"""Called with a stage's name, an iteration and the mean squared error there."""


def fit(
    problem: Problem,
    *,
    stepper: Stepper | None = None,
    settings: Settings = DEFAULT,
    device: str = "cpu",
    precision: str = "double",
    progress: Progress | None = None,
    with_uncertainty: bool = True,
) -> FitResult:
    """Estimate the free parameters and start states of ``problem`` by simulation-error least squares.

    Start values that simulate the records tolerably are refined on whole records at once; poor ones are first improved on short
    windows with free start states, then on longer ones.

    Raises:
        NumericalError: the simulation overflows even over short windows.
    """
    stepper = stepper or make_stepper(problem.model, problem.free_names, device=device, precision=precision)
    substeps = choose_substeps(problem.driving_tape, stepper, problem.values, problem.initial) or 1
    evaluations = 0
    if not _good(problem, stepper, substeps):
        problem, evaluations = _approach(problem, stepper, substeps, progress)
        substeps = choose_substeps(problem.driving_tape, stepper, problem.values, problem.initial) or substeps
    run = FreeRun(problem, stepper, substeps)
    samples = int((~np.isnan(problem.tape.y)).sum())
    if not len(run.start):
        return _unmoved(run, samples)
    report = None
    if progress is not None:
        report = lambda i, cost, _: progress("whole records", i, 2 * cost / samples)  # noqa: E731
    optimum = minimise(
        run.quadratic, run.start, *run.bounds, settings=settings, admissible=run.admissible, on_iteration=report
    )
    if optimum is None:
        raise overflow_error("estimating", problem, stepper, substeps)
    weaknesses = identifiability(run, optimum.point, optimum.model, precision=precision) if with_uncertainty else ()
    return _result(run, optimum, samples, evaluations, with_uncertainty, weaknesses)


def _good(problem: Problem, stepper: Stepper, substeps: int) -> bool:
    """Whether every output of every experiment is simulated better than a rough guess would."""
    fits = [
        fit_percent(problem.tape.y[k, problem.tape.span(e)], run[:, k])
        for e, run in enumerate(simulate(problem, stepper, substeps=substeps))
        for k in range(run.shape[1])
    ]
    return min(fits) > GOOD_START


def _approach(problem: Problem, stepper: Stepper, substeps: int, progress: Progress | None) -> tuple[Problem, int]:
    """Better parameters by way of windows with free start states; each length is kept only if the one before simulates."""
    evaluations, longest = 0, int(problem.tape.lengths.max())
    for share in WINDOW_SHARES:
        found = fit_windows(problem, stepper, max(20, round(share * longest)), substeps=substeps)
        if found is None:
            continue
        evaluations += found.evaluations
        problem = problem.with_values(found.problem.values)
        if progress is not None:
            progress(f"windows of {found.windows.steps} samples", evaluations, found.mean_square)
    return problem, evaluations


def _unmoved(run: FreeRun, samples: int) -> FitResult:
    here = run.quadratic(run.start)
    if here is None:
        raise overflow_error("simulating", run.problem, run.stepper, run.substeps)
    mse = 2 * here.cost / samples
    return FitResult(run.problem, mse, mse, samples, 0, 1, Termination.nothing_free, None, run.substeps)


def _result(
    run: FreeRun,
    optimum: Optimum[None],
    samples: int,
    before: int,
    with_uncertainty: bool,
    weaknesses: tuple[Weakness, ...],
) -> FitResult:
    mse = 2 * optimum.model.cost / samples
    share, problem = len(optimum.point) / samples, run.at(optimum.point)
    return FitResult(
        problem=problem,
        mse=mse,
        fpe=mse * (1 + share) / (1 - share),
        samples=samples,
        iterations=optimum.iterations,
        evaluations=before + optimum.evaluations,
        termination=optimum.termination,
        uncertainty=uncertainty(run, optimum.point) if with_uncertainty else None,
        substeps=run.substeps,
        identifiability=weaknesses,
        notes=notes(problem, weaknesses),
    )
