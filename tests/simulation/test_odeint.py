"""The route by torchdiffeq against the stepper: states, and gradients of a loss."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.simulation.odeint import solve
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.windows import Windows, whole_records
from tests.simulation.arm import PARAMETERS, X0, P, arm_records, arm_with, native


@pytest.mark.parametrize("hold", ["zoh", "foh"])
@pytest.mark.parametrize(("method", "tolerance"), [("rk4", 2e-6), ("dopri5", 2e-8)])
def test_against_torchdiffeq(hold: str, method: str, tolerance: float) -> None:
    records = arm_records((30, 25), hold)
    windows = Windows(np.array([0, 10, 30]), np.array([29, 29, 54]), 20)
    model = arm_with(P)
    x0 = X0 + np.array([[0, 0, 0, 0, 0], [0.01, 0, 1, 0, 0], [0, 0.02, -3, 2, 1]])
    outputs = solve(model, records, windows, torch.tensor(x0.T), method=method, rtol=1e-11, atol=1e-12)
    run = native(names=()).run(records, Pass(windows, P, x0), substeps=1 if method == "rk4" else 8)
    np.testing.assert_allclose(run.y[..., 0].T, outputs[0].detach().numpy(), rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize(("method", "adjoint"), [("rk4", False), ("rk4", True), ("dopri5", True)])
def test_gradients_of_the_torchdiffeq_route(method: str, adjoint: bool) -> None:
    """Against differences of the stepper's loss, which has no step control to make it rough."""
    records = arm_records((14,))
    windows, stepper = whole_records(records), native(names=())
    target = np.linspace(14.0, 17.0, 14)

    def loss(p: np.ndarray, x0: np.ndarray) -> float:
        return float(((stepper.run(records, Pass(windows, p, x0[None]), substeps=8).y[0, :, 0] - target) ** 2).sum())

    model, leaf = arm_with(P), torch.tensor(X0[:, None], requires_grad=True)
    outputs = solve(model, records, windows, leaf, method=method, adjoint=adjoint, rtol=1e-9, atol=1e-10)
    ((outputs[0, :, 0] - torch.tensor(target)) ** 2).sum().backward()
    assert leaf.grad is not None
    for name in ("J", "k_g1", "F_c", "d_a"):
        value = model.values()[name]
        above, below = (loss(changed(name, value * (1 + s)), X0) for s in (1e-5, -1e-5))
        gradient = model.raw[name].grad / model._scales[name]
        assert float(gradient) == pytest.approx((above - below) / (2e-5 * value), rel=1e-5), name
    for i, direction in enumerate(np.eye(5)):
        step = 1e-5 * max(abs(X0[i]), 0.01)
        above, below = (loss(P, X0 + s * step * direction) for s in (1, -1))
        assert float(leaf.grad[i, 0]) == pytest.approx((above - below) / (2 * step), rel=1e-5), i


def changed(name: str, value: float) -> np.ndarray:
    return np.array([{**dict(zip(PARAMETERS, P, strict=True)), name: value}[n] for n in PARAMETERS])
