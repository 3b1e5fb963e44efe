"""The task: windows of a simulated record of the arm, and a friction network at its motor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from experiments.speed.network import network_task
from greybox_torch import GreyBoxModel, ResidualNet, Surroundings
from greybox_torch.estimate import Problem, problem_for
from greybox_torch.mechanisms import AugmentedModel, Range, attach
from greybox_torch.simulation import Records, Simulator
from greybox_torch.systems import RobotArm
from greybox_torch.training.gradients import (
    AdjointGradient,
    Batch,
    RecomputationGradient,
    SequenceGradient,
    TangentsGradient,
)

KEPT = "backpropagation"
WAYS = ("tangents", "recomputation", KEPT, "odeint_adjoint")
"""The three that `--gradient` offers, and beside them backpropagation that keeps every state, for comparison."""

AROUND = Surroundings({"speed": Range(-25.0, 25.0, 14.0)}, {"speed": "rad/s"}, "N m", 5e-4)


def make_task(windows: int, length: int, units: int) -> tuple[Problem, Batch]:
    """``windows`` windows of ``length`` samples, and the arm with a network of the motor's speed, its 3 ``units`` + 1 weights free."""
    drawn = network_task(windows, length)
    arm = RobotArm()
    model = AugmentedModel(arm, [attach(arm, "motor", ResidualNet(units=units))], {"motor": AROUND})
    problem = problem_for(_plain(arm, drawn.records, drawn.p), model, {})
    own = np.array([name.startswith("motor.") for name in problem.names])
    rng = np.random.default_rng(0)
    values = np.where(own & problem.free, problem.values + 0.05 * rng.normal(size=len(own)), problem.values)
    problem = replace(problem, free=own & problem.free).with_values(values)
    return problem, Batch(drawn.records, drawn.windows, drawn.x0)


def make_way(name: str, problem: Problem) -> SequenceGradient:
    """One of :data:`WAYS`."""
    if name == "odeint_adjoint":
        return AdjointGradient(problem)
    if name in ("recomputation", KEPT):
        return RecomputationGradient(problem, chunk=0 if name == KEPT else None)
    return TangentsGradient(problem, compiled(problem))


def compiled(problem: Problem) -> Simulator:
    return Simulator.of(problem.model, problem.free_names)


def true_slope(problem: Problem, batch: Batch) -> np.ndarray:
    """The derivative (d,) of the loss of the differential equation's solution: steps sixteen times as fine."""
    return TangentsGradient(problem, compiled(problem).with_substeps(16))(problem.values, batch).slope


def _plain(model: GreyBoxModel, records: Records, values: np.ndarray) -> Problem:
    count = len(model.states)
    return Problem(
        model=model,
        records=records,
        names=tuple(p.name for p in model.declared_parameters),
        values=values,
        lower=np.array([p.bounds[0] for p in model.declared_parameters]),
        upper=np.array([p.bounds[1] for p in model.declared_parameters]),
        free=np.ones(len(values), dtype=bool),
        initial=np.zeros((len(records.first), count)),
        initial_free=np.ones(count, dtype=bool),
        weights=np.ones(1),
        carried=np.zeros(count, dtype=bool),
        expected=values,
    )
