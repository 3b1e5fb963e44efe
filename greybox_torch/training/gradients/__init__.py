"""Three ways to the gradient of a sequence loss, chosen by name."""

from __future__ import annotations

from greybox_torch.errors import ArgumentError, did_you_mean
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.training.gradients.adjoint import AdjointGradient
from greybox_torch.training.gradients.loss import Batch, Loss, SequenceGradient
from greybox_torch.training.gradients.recomputation import RecomputationGradient
from greybox_torch.training.gradients.tangents import TangentsGradient

GRADIENTS = ("tangents", "recomputation", "odeint_adjoint")
"""Forward sensitivities of the stepper; backpropagation through its steps, these computed again on the way back; the adjoint equation."""


def make_gradient(name: str, problem: Problem, simulator: Simulator) -> SequenceGradient:
    """The gradient called ``name`` of the free parameters of ``problem``.

    Args:
        simulator: of the problem's model, with tangents for its free parameters; only ``tangents`` uses these, the others its options.

    Raises:
        UserError: there is no gradient of that name.
    """
    check_gradient(name)
    if name == "tangents":
        return TangentsGradient(problem, simulator)
    made = RecomputationGradient if name == "recomputation" else AdjointGradient
    return made(problem, simulator.options)


def check_gradient(name: str) -> None:
    """Raises UserError unless ``name`` is one of :data:`GRADIENTS`."""
    if name not in GRADIENTS:
        problem = f"unknown{did_you_mean(name, GRADIENTS)}; expected one of {', '.join(GRADIENTS)}"
        raise ArgumentError("gradient", name, problem)


__all__ = [
    "GRADIENTS",
    "AdjointGradient",
    "Batch",
    "Loss",
    "RecomputationGradient",
    "SequenceGradient",
    "TangentsGradient",
    "check_gradient",
    "make_gradient",
]
