"""Estimating many machines of one model."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

from greybox_torch.api.arguments import check_estimation, check_model, check_moving, check_precision
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.fit import MOST_STARTS, fit
from greybox_torch.api.fit_result import FitResult
from greybox_torch.api.plain_arguments import check_device, check_seed, check_told, check_whole
from greybox_torch.data import DataSet
from greybox_torch.errors import ArgumentError, Kind, NumericalError, UserError
from greybox_torch.estimate.comparison import Comparison
from greybox_torch.estimate.descent import DescentOptions
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.levenberg_marquardt import DEFAULT
from greybox_torch.estimate.precision import settings_for
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.together.comparison import compare_together
from greybox_torch.estimate.together.fit import fit_together, undetermined_at_start
from greybox_torch.estimate.together.free_runs import together
from greybox_torch.estimate.together.substeps import with_fine_steps
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import SimulationOptions, Simulator

AT_ONCE = 128
"""Machines of a batch: enough to fill the lanes of many cores, and their signals still fit into the memory of any of today's machines."""

Failure = UserError | NumericalError


@dataclass(frozen=True)
class _Machine:
    """One data set, its place among those given, and its problem."""

    place: int
    data: DataSet
    problem: Problem


@names_checked
def fit_many(
    model: GreyBoxModel | Any,
    data: Iterable[Data],
    *,
    starts: int | None = None,
    seed: int = 0,
    device: str = "cpu",
    precision: str = "double",
    return_exceptions: bool = False,
    progress: Callable[[str], None] = lambda text: None,
) -> list[FitResult | Failure]:
    """Estimate one model on the recordings of many machines, each with parameters of its own, all in one batch.

    For each machine the iterations are those that :func:`fit` makes for it alone, and the optimum is the same; the
    simulations of all run side by side. A machine whose start values do not simulate tolerably, or turn out poor, goes
    on alone as :func:`fit` does.

    Args:
        model: estimated for each data set from the values that it holds or that its card gives, see :func:`fit`.
        data: a data set for each machine, or its card by path, with start values, bounds and what is fixed of its own.
        starts: how many sets of start values to try for each; by default only those given, and many where these turn
            out poor.
        seed: of the random start values.
        device: "cpu", "cuda" or "cuda:N".
        precision: "double" or "single".
        return_exceptions: give the error in the place of a machine that fails, instead of raising the first one.
        progress: is told what is being done.

    Returns:
        A result for each data set, in their order. ``seconds`` is a machine's share of the time.

    Raises:
        UserError: model and data do not fit, there is no experiment to estimate from, or an argument is at fault.
        NumericalError: even short stretches of a simulation overflow.

    Examples:
        ``[found.parameters["J"].value for found in fit_many(Motor(), data_sets)]``
    """
    given, device, precision = check_model(model), check_device(device), check_precision(precision)
    starts = None if starts is None else check_whole("starts", starts, 1, MOST_STARTS)
    check_seed(seed)
    check_told("progress", progress)
    if isinstance(data, DataSet | str | PathLike):
        raise ArgumentError("data", Kind.of(data), "expected a list of data sets, one for each machine")
    sets = [check_data(each) for each in data]
    result: list[FitResult | Failure | None] = [None] * len(sets)
    machines: list[_Machine] = []
    for place, each in enumerate(sets):
        try:
            check_estimation(each)
            problem = make_problem(each, given, each.estimation())
            check_moving(each, given)
            if _in_a_batch(problem):
                machines.append(_Machine(place, each, problem))
            else:
                result[place] = fit(given, each, starts=starts, seed=seed, device=device, precision=precision)
        except (UserError, NumericalError) as error:
            result[place] = error
    simulator = Simulator.of(given, (), SimulationOptions(device, precision))
    options = DescentOptions(simulator, settings_for(precision, DEFAULT), None, seed)
    for k in range(0, len(machines), AT_ONCE):
        some = machines[k : k + AT_ONCE]
        for machine, found in zip(some, _batch(given, some, options, starts, precision, progress), strict=True):
            result[machine.place] = found
    ended = [each for each in result if each is not None]
    failed = next((each for each in ended if isinstance(each, Exception)), None)
    if failed is not None and not return_exceptions:
        raise failed
    return ended


def _in_a_batch(problem: Problem) -> bool:
    return together(problem) and bool(problem.free.any() or problem.initial_free.any())


def _batch(
    model: GreyBoxModel,
    machines: Sequence[_Machine],
    options: DescentOptions,
    starts: int | None,
    precision: str,
    progress: Callable[[str], None],
) -> list[FitResult | Failure]:
    began = time.perf_counter()
    problems = [machine.problem for machine in machines]
    undetermined = undetermined_at_start(problems, options.simulator)
    found = fit_together(problems, options, starts, progress)
    sound = [k for k, each in enumerate(found) if isinstance(each, Estimation)]
    estimated = [each for each in found if isinstance(each, Estimation)]
    comparisons = _compared(model, [machines[k].data for k in sound], estimated, options.simulator)
    seconds = (time.perf_counter() - began) / len(machines)
    result: list[FitResult | Failure] = [each for each in found if isinstance(each, NumericalError)]
    for k, estimation, own in zip(sound, estimated, comparisons, strict=True):
        result.insert(k, FitResult(machines[k].data, estimation, own, {}, undetermined[k], precision, seconds))
    return result


def _compared(
    model: GreyBoxModel, data: Sequence[DataSet], found: Sequence[Estimation], simulator: Simulator
) -> list[dict[str, Comparison]]:
    """Start and refitted values on all experiments of every machine, as :func:`fit` compares them."""
    every = [each.recordings for each in data]
    own = [each.estimation() for each in data]
    start = [make_problem(each, model, each.recordings) for each in data]
    refit = [
        make_problem(each, model, each.recordings, values=estimate.problem.values_by_name)
        for each, estimate in zip(data, found, strict=True)
    ]
    before = compare_together(start, every, simulator, with_fine_steps(start, simulator).substeps)
    after = compare_together(refit, every, simulator, with_fine_steps(refit, simulator).substeps)
    fitted, substeps = [each.problem for each in found], [each.substeps for each in found]
    there = compare_together(fitted, own, simulator, substeps, estimate_starts=False)
    return [{"start": a, "refit": b.with_experiments_of(c)} for a, b, c in zip(before, after, there, strict=True)]
