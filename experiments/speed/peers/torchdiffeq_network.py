"""One gradient of a batched sequence loss through a friction network with torchdiffeq, eager: adjoint, or backpropagation."""

from __future__ import annotations

import numpy as np
import torch
from torchdiffeq import odeint, odeint_adjoint

from experiments.speed.network import SPEED_SCALE, WIDTH, NetworkTask
from experiments.speed.peers.torchdiffeq_arm import OPTIONS, Arm, grid


class ArmWithNetwork(Arm):
    """The arm with a network of the motor speed that adds to its friction."""

    def __init__(self, p: torch.Tensor, torque: torch.Tensor) -> None:
        super().__init__(p, torque)
        self.network = torch.nn.Sequential(
            torch.nn.Linear(1, WIDTH), torch.nn.Tanh(), torch.nn.Linear(WIDTH, 1)
        ).double()

    def extra_friction(self, motor: torch.Tensor) -> torch.Tensor:
        return self.network(motor[..., None] / SPEED_SCALE)[..., 0]


class NetworkGradient:
    """Loss and gradient (49,) of ``task``, on call; with ``adjoint`` that of the continuous adjoint equation."""

    def __init__(self, task: NetworkTask, *, adjoint: bool) -> None:
        self.adjoint = adjoint
        self.field = ArmWithNetwork(torch.as_tensor(task.p), torch.as_tensor(task.records.u[0, task.index]))
        first, last = self.field.network[0], self.field.network[2]
        self.weights = (first.weight, first.bias, last.weight, last.bias)
        with torch.no_grad():
            for weight, values in zip(
                self.weights, (task.hidden, task.hidden_bias, task.output, task.output_bias), strict=True
            ):
                weight.copy_(torch.as_tensor(values).reshape(weight.shape))
        self.x0 = torch.as_tensor(task.x0)
        self.measured = torch.as_tensor(task.records.y[0, task.index])
        self.times = grid(task.windows.steps)

    def __call__(self) -> tuple[float, np.ndarray]:
        self.field.zero_grad()
        extra = {"adjoint_options": dict(OPTIONS)} if self.adjoint else {}
        integrate = odeint_adjoint if self.adjoint else odeint
        states = integrate(self.field, self.x0, self.times, method="rk4", options=OPTIONS, **extra)
        loss = ((states[..., 2].T - self.measured) ** 2).mean()
        loss.backward()
        gradient = torch.cat([w.grad.reshape(-1) for w in self.weights if w.grad is not None])
        return float(loss.detach()), gradient.numpy().copy()
