"""The physics alone, as well as it can be estimated: what the hybrid has to beat, and where it begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.estimate.fit import Estimation, fit_records
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.training.settings import TrainingSettings
from greybox_torch.training.stages import window_lengths

SETTINGS = Settings(iterations=25, tolerance=1e-3, trials=6)


@dataclass(frozen=True)
class Physics:
    """``result`` on whole records, and ``values`` (n_p,) from the shortest windows: a free run is drawn to parameters that bend the
    curve where physics is missing, short windows hardly are, and so the hybrid begins with these.
    """

    result: Estimation
    values: np.ndarray


def fit_physics(
    data: DataSet,
    model: GreyBoxModel,
    *,
    values: Mapping[str, float] | None = None,
    settings: TrainingSettings | None = None,
    device: str = "cpu",
) -> Physics:
    """``model`` estimated on the experiments of role "estimation", for hybrids of several seeds or networks to share.

    Args:
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``.
        model: the physics, without a network.
        values: parameter values that replace the start values, such as those of a diagnosis for its model.
        settings: of the training that follows: its windows and its seed; by default ``TrainingSettings()``.
        device: "cpu", "cuda" or "cuda:N".

    Raises:
        UserError: no estimation experiment, or records that are too short to train on.
        NumericalError: the simulation overflows from the start values.
    """
    settings = settings or TrainingSettings()
    problem = training_problem(data, model, values)
    simulator = Simulator.of(model, problem.free_names, SimulationOptions(device))
    return estimate_physics(problem, simulator, window_lengths(problem.records, settings), settings.seed)


def training_problem(data: DataSet, model: GreyBoxModel, values: Mapping[str, float] | None = None) -> Problem:
    """``model``, perhaps with effects attached, on the experiments of role "estimation", every start state free that the card leaves open.

    Raises:
        UserError: there is no such experiment.
    """
    if not data.estimation():
        raise UserError(f'{data.place()}: no experiment has the role "estimation"; expected at least one to train on')
    base = model.base if isinstance(model, AugmentedModel) else model
    problem = all_starts_free(data, make_problem(data, base, data.estimation()))
    return problem_for(problem, model, values or {}) if values or base is not model else problem


def estimate_physics(problem: Problem, simulator: Simulator, lengths: Sequence[int], seed: int = 0) -> Physics:
    """The plain model estimated by way of windows of rising ``lengths``, and from its start values directly; the better of the two.

    Raises:
        NumericalError: the simulation overflows either way.
    """
    chain = windows_in_turn(problem, fine_enough(simulator, problem), lengths, None)
    found = []
    if chain:
        found.append(_fitted(on_whole_records(chain[-1], problem), simulator, seed))
    try:
        found.append(_fitted(problem, simulator, seed))
    except NumericalError:
        if not found:
            raise
    best = min(found, key=lambda f: f.mse)
    return Physics(best, chain[0].problem.values if chain else best.problem.values)


def windows_in_turn(
    problem: Problem,
    simulator: Simulator,
    lengths: Sequence[int],
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
        fitted = fit_windows(begun, simulator, length, shorter=before, settings=settings, size=size)
        if fitted is None:
            break
        found.append(fitted)
    return found


def on_whole_records(windows: WindowFit, problem: Problem) -> Problem:
    """``problem`` with the parameters of a window fit, its experiments beginning as their first windows do."""
    first = np.searchsorted(windows.windows.start, problem.records.first)
    initial = np.where(problem.initial_free, windows.starts[first], problem.initial)
    return problem.with_values(windows.problem.values, initial)


def _fitted(problem: Problem, simulator: Simulator, seed: int) -> Estimation:
    return fit_records(problem, simulator=simulator, seed=seed, starts=1)


def with_physics(problem: Problem, physics: np.ndarray) -> Problem:
    """A hybrid's ``problem`` with the values (n,) of its first n parameters, those of the physics."""
    return replace(problem, values=np.concatenate([physics, problem.values[len(physics) :]]))
