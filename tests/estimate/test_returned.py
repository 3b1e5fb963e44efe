"""Parameters that nothing depends on any more return to what is expected of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.returned import returned
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator

UNITS = {"force": "N", "speed": "m/s"}


class Rubbing(GreyBoxModel):
    """dv/dt = force − decay v − level tanh(sharpness v)."""

    states = [State("speed", "m/s", initial="measured")]
    inputs = [Input("force", "N")]
    outputs = [Output("speed", "m/s")]
    parameters = [
        Parameter("decay", 1.0, lower=0.0),
        Parameter("level", 0.5, lower=0.0),
        Parameter("sharpness", 2.0, lower=0.0),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": u.force - p.decay * x.speed - p.level * (p.sharpness * x.speed).tanh()}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


@pytest.fixture
def run(data_set: Any) -> FreeRun:
    """A record without dry friction, under a force that changes every 20 samples."""
    draw = np.random.default_rng(5)
    force, speed = np.repeat(draw.uniform(-2, 2, 20), 20), np.zeros(400)
    for k in range(399):
        speed[k + 1] = force[k] + (speed[k] - force[k]) * np.exp(-0.01)
    data = data_set(UNITS, [{"force": force, "speed": speed + 0.001 * draw.normal(size=400)}])
    problem = make_problem(data, Rubbing(), data.estimation())
    return FreeRun(problem, Simulator.of(problem.model, problem.free_names))


def at(run: FreeRun, **values: float) -> np.ndarray:
    return FreeRun(run.problem.with_values(np.array(list(values.values()))), run.simulator).start


def test_a_level_that_nothing_depends_on_returns_and_its_sharpness_as_far_as_it_may(run: FreeRun) -> None:
    away = at(run, decay=1.0, level=1e82, sharpness=1e-91)
    decay, level, sharpness = returned(run, away)[:3]
    assert (decay, level) == (1.0, 0.5)
    assert 1e-12 < sharpness < 1e-3
    before, after = run.quadratic(away), run.quadratic(returned(run, away))
    assert before is not None and after is not None
    assert after.cost <= before.cost * (1 + 0.02 / run.problem.samples)


def test_what_the_record_determines_stays_however_far_it_is(run: FreeRun) -> None:
    far = replace(run, problem=replace(run.problem, expected=np.array([1e-5, 0.5, 2.0])))
    point = at(run, decay=1.0, level=1e-12, sharpness=2.0)
    assert returned(far, point)[0] == pytest.approx(1.0, rel=1e-3)


def test_what_is_near_stays_as_it_is(run: FreeRun) -> None:
    point = at(run, decay=0.99, level=0.002, sharpness=3.0)
    assert np.array_equal(returned(run, point), point)
