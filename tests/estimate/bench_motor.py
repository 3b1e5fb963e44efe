"""Problems of the documentation's motor."""

from __future__ import annotations

from typing import Any

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State

UNITS = {"voltage": "V", "speed": "rad/s"}
TRUTH = {"J": 0.02, "k": 0.1, "b": 0.05}
NAN = float("nan")


def problem_of(data: DataSet, model: GreyBoxModel) -> Problem:
    return make_problem(data, model, data.estimation())


def noisy(experiments: list[dict[str, np.ndarray]]) -> list[dict[str, np.ndarray]]:
    rng = np.random.default_rng(1)
    return [{**e, "speed": e["speed"] + rng.normal(0, 0.1, len(e["speed"]))} for e in experiments]


def values(found: Estimation) -> dict[str, float]:
    return dict(zip(found.problem.names, map(float, found.problem.values), strict=True))


class Runaway(GreyBoxModel):
    """dx/dt = a x: overflows at once where a is large."""

    states = [State("speed", "rad/s", initial=1.0)]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("a", 1e5, unit="1/s")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": p.a * x.speed + 0.0 * u.voltage}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}
