"""Discretise, then differentiate: backpropagation through the steps, of which only every √K-th state is kept.

The steps between two kept states are computed again on the way back, so that memory grows with the root of the window's length, for one
more forward pass.

Source: A. Griewank, "Achieving logarithmic growth of temporal and spatial complexity in reverse automatic differentiation", 1992;
T. Chen, B. Xu, C. Zhang, C. Guestrin, "Training deep nets with sublinear memory cost", 2016.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isqrt

import numpy as np
import torch
from torch.utils.checkpoint import checkpoint

from greybox_torch.estimate.problem import Problem
from greybox_torch.model import Signals
from greybox_torch.simulation.eager import runge_kutta_step
from greybox_torch.simulation.simulator import DEFAULT, SimulationOptions
from greybox_torch.training.gradients.loss import Batch, Loss, squared_errors


@dataclass(frozen=True)
class RecomputationGradient:
    """See :class:`greybox_torch.training.gradients.loss.SequenceGradient`. The gradient is exact for the steps that are made.

    Args:
        chunk: steps between two kept states; the root of the window's length by default, and nothing is computed again where it is zero.
    """

    problem: Problem
    options: SimulationOptions = DEFAULT
    chunk: int | None = None

    def __call__(self, values: np.ndarray, batch: Batch) -> Loss:
        p = torch.tensor(values, dtype=torch.float64, device=self.options.device, requires_grad=True)
        inputs = _Inputs(self.problem.model.prepared(batch.records, values), batch, self.options.device)
        x = torch.as_tensor(np.ascontiguousarray(batch.starts.T), device=self.options.device)
        steps = batch.windows.steps
        chunk = self.chunk if self.chunk is not None else max(1, isqrt(steps))
        energy = torch.zeros((), dtype=torch.float64, device=self.options.device)
        for first in range(0, steps, chunk or steps):
            stretch = (batch, inputs, first, min(first + (chunk or steps), steps))
            if chunk:  # reentrant: the other kind holds on to what it computed again, and takes three times as long
                x, own = checkpoint(self._advanced, x, p, *stretch, use_reentrant=True)  # type: ignore[misc]
            else:
                x, own = self._advanced(x, p, *stretch)
            energy = energy + own
        energy.backward()
        assert p.grad is not None
        return Loss(float(energy.detach()), p.grad.cpu().numpy()[self.problem.free].copy())

    def _advanced(
        self, x: torch.Tensor, p: torch.Tensor, batch: Batch, inputs: _Inputs, first: int, end: int
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """States (n_x, B) after the samples [first, end), and their squared errors."""
        named, outputs = Signals("parameter", dict(zip(self.problem.names, p.unbind(), strict=True))), []
        rates = lambda z, u, _: self.problem.model.rates(z, u, named)  # noqa: E731
        for n in range(first, end):
            u0, u1, dt = inputs.at(n)
            outputs.append(self.problem.model.measured(x, u0, named))
            for m in range(self.options.substeps):
                step = runge_kutta_step(
                    rates,
                    u0,
                    u1,
                    dt / self.options.substeps,
                    m / self.options.substeps,
                    (m + 1) / self.options.substeps,
                )
                x = step(x, u0, p)
        return x, squared_errors(torch.stack(outputs, dim=1), batch, self.problem.weights, first)


class _Inputs:
    """The inputs of a batch at its samples."""

    def __init__(self, records, batch: Batch, device: str) -> None:
        index = batch.index
        following = np.minimum(index + 1, batch.windows.last[:, None]) if records.hold == "foh" else index
        self.u0, self.u1 = (torch.as_tensor(records.u[:, i], device=device) for i in (index, following))
        self.dt = torch.as_tensor(records.dt[index], device=device)

    def at(self, n: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Inputs (n_u, B) at both ends of the n-th sample interval, and its length (B,) in s."""
        return self.u0[:, :, n], self.u1[:, :, n], self.dt[:, n]
