"""The adjoint equation of the differential equation, by torchdiffeq: constant memory, and errors of the order of the steps'.

Source: R. T. Q. Chen, Y. Rubanova, J. Bettencourt, D. Duvenaud, "Neural ordinary differential equations", 2018.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.odeint import solve
from greybox_torch.simulation.simulator import DEFAULT, SimulationOptions
from greybox_torch.training.gradients.loss import Batch, Loss, squared_errors


@dataclass(frozen=True)
class AdjointGradient:
    """See :class:`greybox_torch.training.gradients.loss.SequenceGradient`.

    The derivative of the solution, not of the steps: it differs from that of the computed loss by what the steps are off.
    """

    problem: Problem
    options: SimulationOptions = DEFAULT

    def __call__(self, values: np.ndarray, batch: Batch) -> Loss:
        p = torch.tensor(values, dtype=torch.float64, device=self.options.device, requires_grad=True)
        x0 = torch.as_tensor(np.ascontiguousarray(batch.starts.T), device=self.options.device)
        model = self.problem.model
        records = model.prepared(batch.records, values)
        y = solve(model, records, batch.windows, x0, values=p, adjoint=True, substeps=self.options.substeps)
        energy = squared_errors(y, batch, self.problem.weights)
        energy.backward()
        assert p.grad is not None
        return Loss(float(energy.detach()), p.grad.cpu().numpy()[self.problem.free].copy())
