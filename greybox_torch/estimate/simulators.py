"""The simulator that a problem needs."""

from __future__ import annotations

from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.simulator import DEFAULT, SimulationOptions, Simulator


def simulator_for(problem: Problem, options: SimulationOptions = DEFAULT, *, tangents: bool = True) -> Simulator:
    """The simulator of a problem's model, with as many sub-steps as its values need (those of ``options`` do not matter).

    Args:
        tangents: for the free parameters of the problem; none without.

    Raises:
        UserError: the model's equations branch on a signal or do not return what the model declares.
    """
    return fine_enough(Simulator.of(problem.model, problem.free_names if tangents else (), options), problem)


def fine_enough(simulator: Simulator, problem: Problem) -> Simulator:
    """``simulator`` with as many sub-steps as ``problem`` needs at its values; with one where no number of them simulates it."""
    return simulator.fine_enough(problem.driving_records, problem.values, problem.initial)
