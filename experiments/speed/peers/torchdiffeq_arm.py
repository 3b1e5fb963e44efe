"""The arm with torchdiffeq: `odeint` with its method rk4, eager, gradients by backpropagation through every step."""

from __future__ import annotations

import numpy as np
import torch
from torchdiffeq import odeint

from experiments.speed.records import SAMPLE_TIME, Published


class Arm(torch.nn.Module):
    """The arm under a torque (..., N) that is held over each sample; states (..., 5), parameters (13,).

    Time is counted in samples, which floating point represents exactly, so that every stage finds its own sample's torque.
    """

    def __init__(self, p: torch.Tensor, torque: torch.Tensor) -> None:
        super().__init__()
        self.p, self.torque = p, torque

    def forward(self, t: torch.Tensor, x: torch.Tensor) -> torch.Tensor:
        now = min(int(t), self.torque.shape[-1] - 1)
        f_v, f_c, f_cs, alpha, beta, inertia, a_m, a_g, k_g1, k_g3, d_g, k_a, d_a = self.p.unbind()
        gear_twist, arm_twist, motor, gearbox, arm = x.unbind(-1)
        stribeck = f_cs / torch.cosh((alpha * motor).clamp(-80.0, 80.0))
        friction = f_v * motor + (f_c + stribeck) * torch.tanh(beta * motor) + self.extra_friction(motor)
        gear = k_g1 * gear_twist + k_g3 * gear_twist**3 + d_g * (motor - gearbox)
        spring = k_a * arm_twist + d_a * (gearbox - arm)
        rates = (
            motor - gearbox,
            gearbox - arm,
            (self.torque[..., now] - friction - gear) / (inertia * a_m),
            (gear - spring) / (inertia * a_g),
            spring / (inertia * (1 - a_m - a_g)),
        )
        return SAMPLE_TIME * torch.stack(rates, dim=-1)

    def extra_friction(self, motor: torch.Tensor) -> torch.Tensor | float:
        """Friction torque at the motor besides the published, N m."""
        return 0.0


def grid(samples: int) -> torch.Tensor:
    """Times of the samples, in samples."""
    return torch.arange(samples, dtype=torch.float64)


OPTIONS = {"perturb": True}
"""Stages at the end of a step look at the time just before it, where the held torque is still that of the step."""


def gradient(task: Published, z: np.ndarray) -> tuple[float, np.ndarray]:
    """Mean squared error and its gradient (10,) at unknowns ``z``."""
    unknowns = torch.tensor(z, dtype=torch.float64, requires_grad=True)
    count = len(task.free)
    p = torch.as_tensor(task.p).index_put((torch.as_tensor(task.free),), unknowns[:count])
    x0 = torch.as_tensor(task.x0).index_put((torch.as_tensor(task.free_states),), unknowns[count:])
    states = odeint(Arm(p, torch.as_tensor(task.u)), x0, grid(len(task.u)), method="rk4", options=OPTIONS)
    loss = ((states[:, 2] - torch.as_tensor(task.y)) ** 2).mean()
    loss.backward()
    assert unknowns.grad is not None
    return float(loss.detach()), unknowns.grad.numpy()
