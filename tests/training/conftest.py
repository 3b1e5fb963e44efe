from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.data import DataSet
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.surroundings import survey
from greybox_torch.mechanisms.friction_net import FrictionNet
from greybox_torch.model import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.training.hybrid import Hybrid, attach_network


class Turntable(GreyBoxModel):
    """J dw/dt = u − b w: what the model knows of the machine below."""

    states = [State("speed", "rad/s", initial="measured")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("J", 0.02, "kg m^2", lower=1e-4), Parameter("b", 0.05, "N m s/rad", lower=0.0)]
    ports = [Body("table", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": (u.torque - p.b * x.speed + port.table) / p.J}

    def output(self, x, u, p):
        return {"speed": x.speed}


def true_friction(speed: np.ndarray) -> np.ndarray:
    """Friction that rises around 4 rad/s, N m: none of the library's laws."""
    return -0.15 * np.exp(-0.5 * ((np.abs(speed) - 4.0) / 1.2) ** 2) * np.tanh(speed / 0.3)


def drag(speed: np.ndarray) -> np.ndarray:
    """Quadratic drag of 0.01 N m s^2/rad^2: one of the library's laws."""
    return -0.01 * speed * np.abs(speed)


def recorded(
    torque: np.ndarray, rng: np.random.Generator, inertia: float = 0.02, b: float = 0.05, friction=true_friction
) -> np.ndarray:
    """Speeds of the machine at samples 10 ms apart, ten Euler steps in each, with noise of 0.02 rad/s."""
    speeds, w = [], 0.5
    for u in torque:
        speeds.append(w)
        for _ in range(10):
            w += 1e-3 * (u - b * w + friction(np.array(w))) / inertia
    return np.array(speeds) + rng.normal(0.0, 0.02, len(torque))


@pytest.fixture(scope="session")
def table_data(data_set) -> DataSet:
    """Two estimation experiments and a validation experiment of the machine."""
    return _table_data(data_set, true_friction)


@pytest.fixture(scope="session")
def drag_data(data_set) -> DataSet:
    """The same of a machine whose missing friction has a name."""
    return _table_data(data_set, drag)


def _table_data(data_set, friction) -> DataSet:
    rng = np.random.default_rng(0)
    torques = [np.repeat(rng.uniform(-0.45, 0.45, n // 20), 20) for n in (1600, 1000, 800)]
    experiments = [{"torque": u, "speed": recorded(u, rng, friction=friction)} for u in torques]
    roles = ["estimation", "estimation", "validation"]
    return data_set({"torque": "N m", "speed": "rad/s"}, experiments, roles=roles)


@pytest.fixture(scope="session")
def table_problem(table_data) -> Problem:
    return make_problem(table_data, Turntable(), table_data.estimation())


@pytest.fixture(scope="session")
def table_hybrid(table_problem) -> Hybrid:
    """The turntable with a network of its speed whose weights are not zero."""
    plain = Simulator.of(table_problem.model, ())
    around = survey(table_problem.model, table_problem, plain)
    made = attach_network(table_problem, "table", FrictionNet(units=3), around)
    heights = np.where(made.heights, 0.05 + 0.02 * np.arange(len(made.heights)) / 4, made.problem.values)
    return replace(made, problem=made.problem.with_values(heights))
