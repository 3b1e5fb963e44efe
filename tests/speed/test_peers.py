"""Every peer computes what our stepper computes, on a short record: a comparison of speed compares equal work."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from experiments.speed.network import network_task
from experiments.speed.peers.torchdiffeq_arm import gradient
from experiments.speed.peers.torchdiffeq_network import NetworkGradient
from experiments.speed.peers.versus import records_for_peers
from experiments.speed.records import NAMES, SAMPLE_TIME, SENSITIVE, SENSITIVE_INDEX, Published, simulated_records
from experiments.speed.row import apart
from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems import RobotArm

SAMPLES = 1200


@pytest.fixture(scope="module")
def records() -> Records:
    return simulated_records(2, SAMPLES)


def arm(records: Records) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parameters, start states and torques; slow at first, so that the friction around rest is at work in so short a record."""
    p, x0, u = records_for_peers(records)
    return p, 0.1 * x0, u


@pytest.fixture(scope="module")
def run(records: Records) -> Run:
    p, x0, _ = arm(records)
    return Simulator.of(RobotArm(), SENSITIVE).run(records, Pass(whole_records(records), p, x0, tangents=True))


@pytest.fixture(scope="module")
def task() -> Published:
    """The published unknowns on a quiet simulated record, a little off its true values."""
    records = simulated_records(1, 600, noise=0.05)
    p, x0, u = records_for_peers(records)
    free, states = np.arange(6, 13), np.arange(2, 5)
    p[free] *= 1.03
    start = np.concatenate([p[free], x0[0, states]])
    low, high = np.full(10, -np.inf), np.full(10, np.inf)
    return Published(u[0], records.y[0], p, x0[0], free, states, np.abs(start), low, high)


def test_the_record_moves_in_both_directions() -> None:
    speed = simulated_records(1, 20000, noise=0.0).y[0]
    assert speed.max() > 5 and speed.min() < -5 and np.isfinite(speed).all()


def test_numba(peers, records: Records, run: Run) -> None:
    peers("numba")
    from experiments.speed.peers import numba_arm

    p, x0, u = arm(records)
    speeds = numba_arm.free_run(np.tile(p, (2, 1)), x0, u, SAMPLE_TIME)
    assert apart(run.y[..., 0], speeds) < 1e-9


def test_numba_sensitivities(peers, records: Records, run: Run) -> None:
    peers("numba")
    from experiments.speed.peers import numba_sensitivities

    p, x0, u = arm(records)
    seed = np.eye(len(NAMES))[:, list(SENSITIVE_INDEX)]
    speeds, derivatives = numba_sensitivities.sensitivities(p, x0, u, SAMPLE_TIME, seed, np.zeros((5, len(SENSITIVE))))
    assert apart(run.y[..., 0], speeds) < 1e-9
    assert run.dy is not None
    for d, name in enumerate(SENSITIVE):
        assert apart(run.dy[:, :, 0, d], derivatives[..., d]) < 1e-9, name


def test_jax(peers, records: Records, run: Run) -> None:
    peers("jax")
    from experiments.speed.peers import jax_arm

    p, x0, u = arm(records)
    assert apart(run.y[..., 0], jax_arm.free_run(SAMPLE_TIME)(p, x0, u)) < 1e-9
    speeds, derivatives = jax_arm.sensitivities(SAMPLE_TIME, SENSITIVE_INDEX)(p, x0, u)
    assert apart(run.y[..., 0], speeds) < 1e-9
    assert run.dy is not None
    for d, name in enumerate(SENSITIVE):
        assert apart(run.dy[:, :, 0, d], np.asarray(derivatives)[..., d]) < 1e-9, name


def test_estimations_arrive_at_one_optimum(peers, task: Published) -> None:
    peers("jax", "optimistix", "numba")
    from experiments.speed.peers import jax_fit, scipy_fit

    data = (task.start, task.p, task.x0, task.u, task.y, task.free, task.free_states)
    errors = [float(method(task.scale)(*data)[1]) for method in jax_fit.METHODS.values()]
    errors.append(scipy_fit.estimate(task, "differences")[1])
    np.testing.assert_allclose(errors, errors[0], rtol=1e-4)
    assert errors[0] == pytest.approx(0.05**2, rel=0.2), "what is left is the noise"


def test_torchdiffeq_has_our_gradient(task: Published) -> None:
    """Its rk4 is the 3/8 rule, which differs from the classical one in the fifth order of the step."""
    p, x0 = task.at(task.start)
    names = [NAMES[i] for i in task.free]
    n = len(task.u)
    own = Records(task.u[None], task.y[None], np.full(n, SAMPLE_TIME), np.array([0]), np.array([n - 1]), ("",), "zoh")
    directions = np.eye(5)[None, list(task.free_states)]
    ours = Simulator.of(RobotArm(), names).run(
        own, Pass(whole_records(own), p, x0[None], tangents=True, start_directions=directions)
    )
    assert ours.dy is not None
    error = ours.y[0, :, 0] - task.y
    loss, slope = gradient(task, task.start)
    assert loss == pytest.approx(np.mean(error**2), rel=1e-6)
    np.testing.assert_allclose(slope, 2 * ours.dy[0, :, 0].T @ error / len(error), rtol=1e-4, atol=1e-7)


def test_network_gradient_against_differences() -> None:
    task = network_task(4, 12)
    adjoint, back = NetworkGradient(task, adjoint=True), NetworkGradient(task, adjoint=False)
    loss, slope = back()
    assert len(slope) == 49
    assert apart(adjoint()[1], slope) < 1e-5
    with torch.no_grad():
        back.weights[2][0, 3] += 1e-5
    assert (back()[0] - loss) / 1e-5 == pytest.approx(slope[16 + 16 + 3], rel=1e-3)
