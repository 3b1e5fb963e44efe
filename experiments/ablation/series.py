"""Recordings as the network alone sees them: scaled, and step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch import DataSet, GreyBoxModel, Recording

SAMPLES = 2500
"""Samples of the longest estimation record that the network steps through: of more, inputs are averaged over a few."""


@dataclass(frozen=True)
class Series:
    """An experiment in scaled units: inputs (N, n_u), outputs (N, n_y) without gaps, and which of these were measured (N, n_y)."""

    u: torch.Tensor
    y: torch.Tensor
    known: torch.Tensor


@dataclass(frozen=True)
class Scaling:
    """``stride`` samples make a step; means and spreads of inputs and outputs in the estimation experiments."""

    stride: int
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    u: tuple[np.ndarray, np.ndarray]
    y: tuple[np.ndarray, np.ndarray]

    @staticmethod
    def of(data: DataSet, model: GreyBoxModel) -> Scaling:
        inputs, outputs = tuple(i.name for i in model.inputs), tuple(o.name for o in model.outputs)
        longest = max(len(r.time) for r in data.estimation())
        u, y = (
            np.concatenate([np.stack([r.signals[n] for n in names], axis=1) for r in data.estimation()])
            for names in (inputs, outputs)
        )
        of_u, of_y = _mean_and_spread(u), _mean_and_spread(_without_gaps(y))
        return Scaling(max(1, round(longest / SAMPLES)), inputs, outputs, of_u, of_y)

    def series(self, recording: Recording) -> Series:
        """A recording step by step."""
        u, y = (np.stack([recording.signals[n] for n in names], axis=1) for names in (self.inputs, self.outputs))
        steps = len(u) // self.stride
        means = u[: steps * self.stride].reshape(steps, self.stride, -1).mean(axis=1)
        sampled = y[: steps * self.stride : self.stride]
        scaled_u, scaled_y = (means - self.u[0]) / self.u[1], (_without_gaps(sampled) - self.y[0]) / self.y[1]
        return Series(torch.as_tensor(scaled_u), torch.as_tensor(scaled_y), torch.as_tensor(~np.isnan(sampled)))

    def outputs_of(self, recording: Recording, y: torch.Tensor) -> np.ndarray:
        """Scaled outputs step by step (N, n_y), brought back to the samples of a recording and to their units."""
        values, (mean, spread) = y.numpy(), self.y
        at, samples = np.arange(len(values)) * self.stride, np.arange(len(recording.time))
        return np.stack([np.interp(samples, at, column) for column in (values * spread + mean).T], axis=1)


def _mean_and_spread(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return values.mean(axis=0), np.maximum(values.std(axis=0), 1e-12)


def _without_gaps(y: np.ndarray) -> np.ndarray:
    """``y`` (N, n) with missing values on straight lines between their neighbours."""
    index = np.arange(len(y))
    return np.stack([np.interp(index, index[~np.isnan(c)], c[~np.isnan(c)]) for c in y.T], axis=1)
