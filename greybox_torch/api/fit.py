"""Estimating the free parameters and start states of a model."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

from greybox_torch.api.arguments import check_estimation, check_model, check_moving, check_precision
from greybox_torch.api.asked_of_channels import asked_where_poor
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.fit_result import FitResult
from greybox_torch.api.plain_arguments import check_device, check_names, check_seed, check_told, check_whole
from greybox_torch.data import DataSet
from greybox_torch.estimate.comparison import Comparison, compare
from greybox_torch.estimate.fit import Estimation, fit_records
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.held_starts import held_starts
from greybox_torch.estimate.identifiability import Unidentifiable, identifiability
from greybox_torch.estimate.levenberg_marquardt import DEFAULT
from greybox_torch.estimate.precision import settings_for
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.profile import SETTINGS, Profile, check_profiled, profile
from greybox_torch.estimate.simulators import fine_enough, simulator_for
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import SimulationOptions, Simulator

MOST_STARTS = 4096


@names_checked
def fit(
    model: GreyBoxModel | Any,
    data: Data,
    *,
    starts: int | None = None,
    seed: int = 0,
    profiles: Iterable[str] = (),
    device: str = "cpu",
    precision: str = "double",
    progress: Callable[[str], None] = lambda text: None,
) -> FitResult:
    """Estimate the free parameters and start states on the experiments of role "estimation"; score all experiments.

    Args:
        model: estimated from the values that it holds: those set by ``set_values()``, else the start values of the data set's card, else
            the declared ones. It stays as it is; the result's ``model`` is a copy with the estimates.
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``; or their card by path.
        starts: how many sets of start values to try, drawn around those given; by default only those given, and many
            where these turn out poor.
        seed: of the random start values.
        profiles: names of free parameters whose profile likelihood (95 % interval) is wanted too. Ctrl-C while they are computed ends them
            alone: the estimate is returned, without the profiles that were not done.
        device: "cpu", "cuda" or "cuda:N".
        precision: "double" or "single".
        progress: is told what is being done.

    Raises:
        UserError: model and data do not fit, there is no experiment to estimate from, no output moves there, or an argument is at
            fault.
        NumericalError: even short stretches of the simulation overflow.

    Examples:
        ``fit(Motor(), data).parameters["J"].value``
    """
    began = time.perf_counter()
    given, device, precision = check_model(model), check_device(device), check_precision(precision)
    starts = None if starts is None else check_whole("starts", starts, 1, MOST_STARTS)
    check_told("progress", progress)
    data = check_data(data)
    check_estimation(data)
    problem = make_problem(data, given, data.estimation())
    check_moving(data, given)
    names = check_names("profiles", profiles)
    check_profiled(names, problem.free_names, problem.names, given.title)
    simulator = simulator_for(problem, SimulationOptions(device, precision))
    unidentifiable = _at_start(problem, simulator)
    for one in unidentifiable:
        progress(f"At the start values: {one.sentence}.")
    found = fit_records(
        problem,
        simulator=simulator,
        settings=settings_for(precision, DEFAULT),
        progress=lambda stage, k, error: progress(f"{stage}, iteration {k}: mean squared error {error:.6g}"),
        starts=starts,
        seed=check_seed(seed),
    )
    drawn = _profiles(found, simulator, names, precision, progress)
    comparisons = _compared(data, given, found, simulator)
    values = found.problem.values_by_name
    asked = asked_where_poor(data, given, comparisons["refit"].scores, lambda: simulator, progress, values)
    question = None if asked is None else asked.question
    held = held_starts(data, found.problem, found.mse, simulator)
    seconds = time.perf_counter() - began
    return FitResult(data, found, comparisons, drawn, unidentifiable, precision, seconds, question, held)


def _at_start(problem: Problem, simulator: Simulator) -> tuple[Unidentifiable, ...]:
    """What the data do not determine, as far as the start values tell."""
    start = FreeRun(problem, simulator)
    return identifiability(start, start.start)


def _profiles(
    found: Estimation, simulator: Simulator, names: tuple[str, ...], precision: str, progress: Callable[[str], None]
) -> dict[str, Profile]:
    """Those that were done before Ctrl-C, if it came: the estimate would be lost with them."""
    drawn: dict[str, Profile] = {}
    try:
        for name in names:
            progress(f"profile of {name}: Ctrl-C leaves it out, and keeps the estimate")
            drawn[name] = profile(found, simulator, name, settings=settings_for(precision, SETTINGS))
            progress(f"profile of {name}: {len(drawn[name].values)} points")
    except KeyboardInterrupt:
        left = ", ".join(name for name in names if name not in drawn)
        progress(f"interrupted: the estimate is kept, without the profile of {left}")
    return drawn


def _compared(data: DataSet, model: GreyBoxModel, found: Estimation, simulator: Simulator) -> dict[str, Comparison]:
    """Start and refitted values on all experiments.

    Start states come from the first tenth of each, but for the refit on the experiments it was estimated on: there they are its own, and so
    is the number of steps that a sample takes. All else is simulated as `compare` does.
    """
    recordings = data.recordings
    start = make_problem(data, model, recordings)
    before = compare(start, recordings, fine_enough(simulator, start))
    refit = make_problem(data, model, recordings, values=found.problem.values_by_name)
    everywhere = compare(refit, recordings, fine_enough(simulator, refit))
    own = compare(found.problem, data.estimation(), simulator.with_substeps(found.substeps), estimate_starts=False)
    return {"start": before, "refit": everywhere.with_experiments_of(own)}
