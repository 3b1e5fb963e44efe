"""Adam on a vector of unknowns, with its moments kept in a :class:`TrainingState`."""

from __future__ import annotations

import math

import numpy as np
import torch

from greybox_torch.training.state import TrainingState

LAST = 0.05
"""Learning rate at the end of a window length, as a share of the first."""


class Adam:
    """torch's Adam, taken up where a state left it.

    Source: D. P. Kingma and J. Ba, "Adam: a method for stochastic optimization", 2015.
    """

    def __init__(self, state: TrainingState, clip: float) -> None:
        self.unknowns = torch.tensor(state.z, requires_grad=True)
        self.clip = clip
        self.inner = torch.optim.Adam([self.unknowns])
        if state.steps:
            moments = {"exp_avg": torch.tensor(state.first), "exp_avg_sq": torch.tensor(state.second)}
            held = self.inner.state_dict()
            held["state"] = {0: {"step": torch.tensor(float(state.steps)), **moments}}
            self.inner.load_state_dict(held)

    def proposed(self, z: np.ndarray, slope: np.ndarray, learning_rate: float) -> np.ndarray:
        """Where one step with the gradient ``slope`` (d,) leads from ``z`` (d,); a gradient longer than ``clip`` is shortened to it."""
        with torch.no_grad():
            self.unknowns.copy_(torch.as_tensor(z))
        self.unknowns.grad = torch.tensor(slope)
        torch.nn.utils.clip_grad_norm_([self.unknowns], self.clip)
        for group in self.inner.param_groups:
            group["lr"] = learning_rate
        self.inner.step()
        return self.unknowns.detach().numpy().copy()

    def keep(self, state: TrainingState) -> None:
        """Write the moments into ``state``."""
        own = self.inner.state[self.unknowns]
        state.steps = int(own["step"])
        state.first, state.second = own["exp_avg"].numpy().copy(), own["exp_avg_sq"].numpy().copy()


def learning_rate(first: float, epoch: int, epochs: int) -> float:
    """A half cosine from ``first`` to :data:`LAST` of it. Source: I. Loshchilov and F. Hutter, "SGDR", 2017."""
    return first * (LAST + (1.0 - LAST) * 0.5 * (1.0 + math.cos(math.pi * epoch / epochs)))
