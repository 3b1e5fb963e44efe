"""Standard deviations where something was added to the sum of squares."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.uncertainty import uncertainty
from greybox_torch.simulation.simulator import Simulator

from ..machines.motor import Motor


@pytest.fixture
def run(data_set, motor_speed) -> FreeRun:
    """The motor with noise of 0.05 rad/s, at its true parameters but for k, which is fixed."""
    rng = np.random.default_rng(0)
    voltage = np.repeat(rng.uniform(-5, 5, 30), 20)
    speed = motor_speed(voltage) + rng.normal(0.0, 0.05, len(voltage))
    data = data_set({"voltage": "V", "speed": "rad/s"}, [{"voltage": voltage, "speed": speed}])
    problem = make_problem(data, Motor(), data.recordings, values={"J": 0.02, "k": 0.1, "b": 0.05})
    return FreeRun(problem, Simulator.of(problem.model, problem.free_names))


def test_no_penalty_is_a_penalty_of_zero(run: FreeRun) -> None:
    without, zero = uncertainty(run, run.start), uncertainty(run, run.start, np.zeros(len(run.start)))
    np.testing.assert_allclose(without.plain, zero.plain, rtol=1e-9)
    np.testing.assert_allclose(without.sandwich, zero.sandwich, rtol=1e-9)


def test_a_penalty_counts_as_knowledge(run: FreeRun) -> None:
    """The plain covariance is that of the sum of both curvatures; what is held firmly hardly varies, by either reckoning."""
    model = run.quadratic(run.start)
    assert model is not None
    penalty = np.zeros(len(run.start))
    penalty[0] = 3.0 * model.hessian[0, 0]
    found, free = uncertainty(run, run.start, penalty), uncertainty(run, run.start)
    variance = 2.0 * model.cost / (run.problem.samples - len(run.start))
    np.testing.assert_allclose(found.plain, variance * np.linalg.inv(model.hessian + np.diag(penalty)), rtol=1e-8)
    firm = uncertainty(run, run.start, 1e8 * penalty)
    for kind in ("plain", "sandwich"):
        assert firm.deviations(kind)[0] < 1e-2 * found.deviations(kind)[0] < free.deviations(kind)[0]
