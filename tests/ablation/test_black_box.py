"""The network alone: its recurrence, what it is begun with, and that training makes its simulation better."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from experiments.ablation.black_box import MEMORY, BlackBox, train_black_box
from experiments.ablation.series import Scaling, Series

from ..machines.motor import Motor


@pytest.fixture
def series() -> Series:
    """A saturating first-order lag: y_k = 0.9 y_{k-1} + 0.3 tanh(2 u_{k-1}), 600 steps."""
    rng = np.random.default_rng(0)
    u = np.repeat(rng.uniform(-2, 2, 60), 10)
    y = np.zeros(600)
    for k in range(1, 600):
        y[k] = 0.9 * y[k - 1] + 0.3 * np.tanh(2 * u[k - 1])
    both = (torch.as_tensor(v)[:, None] for v in (u, y))
    return Series(*both, torch.ones(600, 1, dtype=torch.bool))


def test_the_recurrence(series: Series) -> None:
    """Step by step as the formula in the module says, in numpy."""
    network = BlackBox(1, 1, 3, seed=1)
    with torch.no_grad():
        for parameter in network.parameters():
            parameter.copy_(0.1 * torch.randn(parameter.shape, generator=torch.Generator().manual_seed(2)))
    linear, hidden, bias, out, constant = (
        p.detach().numpy() for p in (network.linear, network.hidden, network.bias, network.out, network.constant)
    )
    y, u = series.y[:30, 0].numpy().copy(), series.u[:30, 0].numpy()
    for k in range(MEMORY, 30):
        seen = np.concatenate([y[k - MEMORY : k][::-1], u[k - MEMORY : k][::-1]])
        y[k] = y[k - 1] + linear[0] @ seen + np.tanh(hidden @ seen + bias) @ out[:, 0] + constant[0]
    simulated = network.simulated(Series(series.u[:30], series.y[:30], series.known[:30]))
    np.testing.assert_allclose(simulated[:, 0].numpy(), y, rtol=1e-12)


def test_a_linear_machine_is_begun_exactly(series: Series) -> None:
    y = torch.zeros(600, 1, dtype=torch.float64)
    for k in range(1, 600):
        y[k] = 0.8 * y[k - 1] + 0.5 * series.u[k - 1]
    network = BlackBox(1, 1, 4, seed=0)
    linear = Series(series.u, y, series.known)
    network.begin([linear])
    np.testing.assert_allclose(network.simulated(linear).numpy(), y.numpy(), atol=1e-9)


def test_training_lowers_the_error_of_the_simulation(series: Series) -> None:
    """Over the held-out windows, on which no step is taken."""
    hardly, fully = (train_black_box([series], seed=0, passes=passes)[1] for passes in (0.001, 0.3))
    assert fully < 0.8 * hardly


def test_the_same_seed_gives_the_same_network(series: Series) -> None:
    one, other, another = (train_black_box([series], seed, passes=0.02)[0] for seed in (3, 3, 4))
    for name, value in one.state_dict().items():
        torch.testing.assert_close(value, other.state_dict()[name], rtol=1e-9, atol=1e-12)
    assert not torch.equal(one.hidden, another.hidden)


def test_scaling_and_back(data_set) -> None:
    """What is measured comes back at every sample, gaps are known as such."""
    speed = np.sin(np.arange(200) / 20)
    speed[50:53] = np.nan
    data = data_set({"voltage": "V", "speed": "rad/s"}, [{"voltage": np.arange(200.0), "speed": speed}])
    scaling, recording = Scaling.of(data, Motor()), data.recordings[0]
    series = scaling.series(recording)
    assert int((~series.known).sum()) == 3 and bool(torch.isfinite(series.y).all())
    back = scaling.outputs_of(recording, series.y)[:, 0]
    known = ~np.isnan(speed)
    np.testing.assert_allclose(back[known], speed[known], atol=1e-12)
    assert float(series.u.mean()) == pytest.approx(0.0, abs=1e-12)
    assert float(series.u.std(correction=0)) == pytest.approx(1.0)
