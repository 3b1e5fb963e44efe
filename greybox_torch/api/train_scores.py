"""Free runs of what a training goes through: start values, physics alone, hybrid, and the law that replaces its network."""

from __future__ import annotations

from greybox_torch.data import DataSet
from greybox_torch.estimate.comparison import Comparison, compare
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.training import Explanation, Trained

START, PHYSICS, HYBRID, NAMED = "start", "refit", "augmented", "named"
"""As in `verdict.json`: the given values, the physics alone, and the hybrid; "named" is the law that replaces the network, if one does."""


def free_runs_of(
    data: DataSet, model: GreyBoxModel, found: Trained, explained: Explanation | None, device: str
) -> dict[str, Comparison]:
    """All experiments simulated by each model, start states estimated on the first tenth of each."""
    start = make_problem(data, model, data.recordings)
    plain = simulator_for(start, SimulationOptions(device), tangents=False)
    refit = all_starts_free(data, start).with_values(found.physics.problem.values)
    runs = {
        START: compare(start, data.recordings, plain),
        PHYSICS: compare(refit, data.recordings, plain.with_substeps(found.physics.substeps)),
        HYBRID: _free_runs(data, start, found.result, device),
    }
    if explained is not None and explained.result is not None:
        runs[NAMED] = _free_runs(data, start, explained.result, device)
    return runs


def _free_runs(data: DataSet, start: Problem, found: Estimation, device: str) -> Comparison:
    model = found.problem.model
    problem = all_starts_free(data, problem_for(start, model, {})).with_values(found.problem.values)
    return compare(
        problem, data.recordings, Simulator.of(model, (), SimulationOptions(device, substeps=found.substeps))
    )
