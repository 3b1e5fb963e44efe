"""Estimating the free parameters and start states of a model from recordings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.beginnings import cost_of
from greybox_torch.estimate.correlation import CorrelationMatrix, correlation_matrix
from greybox_torch.estimate.descent import Descent, DescentOptions, Progress
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.identifiability import Unidentifiable, identifiability
from greybox_torch.estimate.information import UNSEEN, energy_of
from greybox_torch.estimate.levenberg_marquardt import DEFAULT, Settings
from greybox_torch.estimate.metrics import final_prediction_error
from greybox_torch.estimate.nested import descend_nested
from greybox_torch.estimate.notes import notes
from greybox_torch.estimate.overflow import overflow_error
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.termination import Outcome, Termination
from greybox_torch.estimate.uncertainty import Uncertainty, uncertainty
from greybox_torch.linear_algebra import on_one_thread
from greybox_torch.simulation.simulator import Simulator

SAME_COST = {"double": 1e-9, "single": 1e-5}
"""Relative change of the cost that rounding alone accounts for."""


@dataclass(frozen=True)
class Estimation:
    """An estimate: the problem at its optimum and what is known about it.

    ``mse`` is the mean squared weighted error; ``fpe`` Akaike's final prediction error with d counting free parameters and free start
    states, infinite from d = samples on; ``uncertainty`` covers the unknowns in the order free parameters, then start states experiment
    by experiment. ``identifiability`` says what the data do not determine at the optimum, ``notes`` what is to be known beside its
    ``termination``.
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
    identifiability: tuple[Unidentifiable, ...] = ()
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
        lost = {name for one in self.identifiability if one.undetermined for name in one.parameters}
        named = zip(self.problem.free_names, map(float, values), strict=False)
        return {name: float("inf") if name in lost else value for name, value in named}

    def initial_deviations(self, kind: str = "plain") -> np.ndarray:
        """Standard deviations (E, n_x) of the start states, zero where fixed."""
        result = np.zeros_like(self.problem.initial)
        if self.uncertainty is not None:
            own = self.uncertainty.deviations(kind)[len(self.problem.free_names) :]
            result[:, self.problem.initial_free] = own.reshape(len(result), -1)
        return result


@on_one_thread
def fit_records(
    problem: Problem,
    *,
    simulator: Simulator | None = None,
    settings: Settings = DEFAULT,
    progress: Progress | None = None,
    with_uncertainty: bool = True,
    starts: int | None = None,
    seed: int = 0,
) -> Estimation:
    """Estimate the free parameters and start states of ``problem`` by simulation-error least squares.

    Start values that simulate the records tolerably are refined on whole records at once; others are first improved on short
    windows with free start states, then on longer ones. They are judged with the start states given, and, where these do not simulate, with
    those estimated on the first tenth of each record; no estimate is worse than that. Where the error turns out to be less than half of
    what it was at the start values, they were poor, and another valley may be deeper: many more are drawn around them and tried.
    Where parameters start at zero, the model without them is estimated as well; where that is better, the estimation begins there.

    Args:
        simulator: with tangents for the problem's free parameters; by default one on the CPU in double precision. How many sub-steps are
            made is chosen anew.
        starts: how many start values to try, those given among them; 1 for these alone, None to decide as told above.
        seed: of the start values drawn.

    Raises:
        NumericalError: the simulation overflows even over short windows.
    """
    simulator = simulator or Simulator.of(problem.model, problem.free_names)
    options = DescentOptions(simulator, settings, progress, seed)
    if not problem.free.any() and not problem.initial_free.any():
        return _unmoved(FreeRun(problem, options.fine_enough(problem)), problem.samples)
    found = descend_nested(problem, options, starts)
    if found is None:
        raise overflow_error("estimating", problem, options.fine_enough(problem))
    unidentifiable = ()
    if with_uncertainty:
        unidentifiable = identifiability(found.run, found.optimum.point, found.optimum.model)
    return estimation_of(found, problem.samples, with_uncertainty, unidentifiable)


def _unmoved(run: FreeRun, samples: int) -> Estimation:
    here = run.quadratic(run.start)
    if here is None:
        raise overflow_error("simulating", run.problem, run.simulator)
    mse = 2 * here.cost / samples
    return Estimation(run.problem, mse, mse, samples, 0, 1, Termination.nothing_free, None, run.simulator.substeps)


def estimation_of(
    found: Descent, samples: int, with_uncertainty: bool, unidentifiable: tuple[Unidentifiable, ...]
) -> Estimation:
    """What an optimum comes to."""
    run, optimum = found.run, found.optimum
    mse = 2 * optimum.model.cost / samples
    point = _begun_where_without_effect(found, unidentifiable)
    problem = run.at(point)
    return Estimation(
        problem=problem,
        mse=mse,
        fpe=final_prediction_error(mse, len(point), samples),
        samples=samples,
        iterations=optimum.iterations,
        evaluations=found.evaluations,
        termination=optimum.termination,
        uncertainty=uncertainty(run, point) if with_uncertainty else None,
        substeps=run.simulator.substeps,
        identifiability=unidentifiable,
        notes=notes(problem, unidentifiable),
    )


def _begun_where_without_effect(found: Descent, unidentifiable: tuple[Unidentifiable, ...]) -> np.ndarray:
    """The optimum (d,) with parameters that nothing depends on as they began: a descent leaves them where rounding errors lead it.

    Where the cost is not the same there, they had an effect on the way, and it stays as it is. So it does where the values as they began
    and those found together break a constraint of the model.
    """
    run, point = found.run, found.optimum.point.copy()
    names, expected = run.problem.free_names, run.problem.expected[run.problem.free]
    for one in unidentifiable:
        if one.kind == "unmoved":
            point[names.index(one.parameters[0])] = expected[names.index(one.parameters[0])]
    if np.array_equal(point, found.optimum.point):
        return point
    return point if run.admissible(point) and _as_good(run, point, found.optimum.point) else found.optimum.point


def _as_good(run: FreeRun, point: np.ndarray, optimum: np.ndarray) -> bool:
    """Whether the cost at ``point`` (d,) is that of the ``optimum`` (d,), but for rounding and for effects too small to be seen.

    Both are computed anew: a run that has learned where its windows start rounds in another way.
    """
    precision = run.simulator.options.precision
    there, here = (cost_of(run.at(z), run.simulator) for z in (point, optimum))
    return there <= (1 + SAME_COST[precision]) * here + UNSEEN[precision] * energy_of(run)
