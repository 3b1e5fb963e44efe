"""Our side of the network row: the weights are parameters of the model like any other, so the compiled tangents serve."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import torch

from experiments.speed.network import SPEED_SCALE, WIDTH, NetworkTask
from greybox_torch import Parameter, Signals
from greybox_torch.simulation import Pass, Simulator
from greybox_torch.systems import RobotArm

WEIGHTS = (*(f"{kind}_{k}" for kind in ("hidden", "bias", "output") for k in range(WIDTH)), "output_bias")


class ArmWithNetwork(RobotArm):
    """The arm with a network of the motor speed that adds to its friction."""

    name = "robot_arm_with_network"
    parameters = [*RobotArm.declared_parameters, *(Parameter(name, 0.0) for name in WEIGHTS)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        speed = x.motor_speed / SPEED_SCALE
        units = [p[f"output_{k}"] * torch.tanh(p[f"hidden_{k}"] * speed + p[f"bias_{k}"]) for k in range(WIDTH)]
        forces = {place.name: port[place.name] for place in self.all_ports}
        forces["motor"] = forces["motor"] - (sum(units) + p.output_bias)
        return super().derivative(x, u, p, Signals("port", forces))


@lru_cache(maxsize=1)
def _simulator() -> Simulator:
    return Simulator.of(ArmWithNetwork(), WEIGHTS)


def ours_network_gradient(task: NetworkTask) -> tuple[float, np.ndarray]:
    """Loss and gradient (49,) of :class:`NetworkTask`. What is compiled once is kept between calls."""
    weights = np.concatenate([task.hidden, task.hidden_bias, task.output, task.output_bias])
    run = _simulator().run(
        task.records, Pass(task.windows, np.concatenate([task.p, weights]), task.x0, tangents=True, weights=np.ones(1))
    )
    assert run.normal is not None
    total, count = run.normal.sum(axis=0), len(task.x0) * task.windows.steps
    return float(total[-1, -1]) / count, -2.0 * total[:-1, -1] / count
