"""Forward sensitivities: the stepper propagates one tangent a parameter beside the states, in compiled code.

Time grows with the number of parameters, memory not with the length of a window. For the tens of weights of a network at a port this
is the fastest way by far, see `docs/validation/gradients.md`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.training.gradients.loss import Batch, Loss


@dataclass(frozen=True)
class TangentsGradient:
    """See :class:`greybox_torch.training.gradients.loss.SequenceGradient`. The gradient is exact for the steps that are made."""

    problem: Problem
    simulator: Simulator

    def __call__(self, values: np.ndarray, batch: Batch) -> Loss:
        total = self.normal(values, batch)
        return Loss(float(total[-1, -1]), -2.0 * total[:-1, -1])

    def normal(self, values: np.ndarray, batch: Batch) -> np.ndarray:
        """[J e]ᵀ[J e] (d + 1, d + 1) of the outputs' sensitivities to the free parameters and the weighted errors."""
        run = self.simulator.run(
            self.problem.model.prepared(batch.records, values),
            Pass(batch.windows, values, batch.starts, tangents=True, weights=self.problem.weights),
        )
        assert run.normal is not None
        return run.normal.sum(axis=0)
