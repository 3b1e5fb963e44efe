"""What parameters change of a model's rates and outputs at given states and inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.model import GreyBoxModel
from greybox_torch.model.signals import parameter_signals

STEP = 1e-6
"""Relative step of the differences that slopes are taken by."""


@dataclass(frozen=True)
class RatesAndOutputs:
    """Rates and outputs (n_x + n_y, N) of ``model`` at ``states`` (n_x, N) and ``inputs`` (n_u, N), with parameters of such ``values``."""

    model: GreyBoxModel
    values: Mapping[str, float]
    states: torch.Tensor
    inputs: torch.Tensor

    def between(self, first: Mapping[str, float], second: Mapping[str, float]) -> np.ndarray:
        """By how much they are more (n_x + n_y, N) with parameters as ``second`` has them than as ``first`` does."""
        return self.of(second) - self.of(first)

    def slope(
        self, name: str, bounds: tuple[float, float], typical: float, beside: Mapping[str, float] | None = None
    ) -> np.ndarray:
        """Their derivative (n_x + n_y, N) by a parameter, by a difference within its bounds.

        Args:
            typical: a value of it from which the step is reckoned where it is zero.
            beside: other parameters as they are to be.
        """
        value, others = self.values[name], beside or {}
        step = STEP * (abs(value) or abs(typical) or 1.0)
        low, high = max(value - step, bounds[0]), min(value + step, bounds[1])
        return self.between({**others, name: low}, {**others, name: high}) / max(high - low, 1e-300)

    def of(self, values: Mapping[str, float]) -> np.ndarray:
        """They themselves, with these values in the place of their own."""
        p = parameter_signals({**self.values, **values})
        with torch.no_grad(), np.errstate(all="ignore"):
            shown = (self.model.rates, self.model.measured)
            return torch.cat([one(self.states, self.inputs, p) for one in shown]).numpy()
