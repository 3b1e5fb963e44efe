"""The loss of a batch of windows, whichever way its gradient is found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch

from greybox_torch.simulation.records import Records
from greybox_torch.simulation.windows import Windows


@dataclass(frozen=True)
class Batch:
    """Windows of ``records`` with their start states (B, n_x); samples without weight (warm-up, missing ones) are NaN there."""

    records: Records
    windows: Windows
    starts: np.ndarray

    @property
    def index(self) -> np.ndarray:
        """Samples (B, K) of the records that the windows cover; beyond the end of a window its last one."""
        wanted = self.windows.start[:, None] + np.arange(self.windows.steps)
        return np.minimum(wanted, self.windows.last[:, None])

    @property
    def inside(self) -> np.ndarray:
        """Which of them (B, K) belong to the window."""
        return self.windows.start[:, None] + np.arange(self.windows.steps) <= self.windows.last[:, None]

    @property
    def samples(self) -> int:
        """How many measured values the loss compares."""
        return int((~np.isnan(self.records.y[:, self.index]) & self.inside).sum())


@dataclass(frozen=True)
class Loss:
    """Sum of the squared weighted errors of a batch, and its gradient (d,) by the free parameters in their units."""

    energy: float
    slope: np.ndarray

    @property
    def finite(self) -> bool:
        return bool(np.isfinite(self.energy) and np.isfinite(self.slope).all())


class SequenceGradient(Protocol):
    """Loss and gradient of a batch at parameter values (n_p,); not finite where the simulation is not."""

    def __call__(self, values: np.ndarray, batch: Batch) -> Loss: ...


def squared_errors(simulated: torch.Tensor, batch: Batch, weights: np.ndarray, first: int = 0) -> torch.Tensor:
    """Sum of the squared weighted errors of ``simulated`` (n_y, K', B): the outputs from the sample ``first`` of each window on."""
    stretch = slice(first, first + simulated.shape[1])
    measured = torch.as_tensor(np.swapaxes(batch.records.y[:, batch.index[:, stretch]], 1, 2)).to(simulated)
    known = ~torch.isnan(measured) & torch.as_tensor(batch.inside[:, stretch].T).to(simulated.device)
    error = torch.where(known, torch.nan_to_num(measured) - simulated, torch.zeros_like(simulated))
    return ((error * torch.as_tensor(weights).to(simulated)[:, None, None]) ** 2).sum()
