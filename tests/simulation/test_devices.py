"""A graphics processor gives the numbers that the processor gives."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.odeint import solve
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.windows import Windows
from tests.cuda import needs_cuda
from tests.simulation.arm import X0, P, arm_records, arm_with, native

WINDOWS = Windows(np.array([0, 20, 60]), np.array([59, 59, 104]), 40)
STARTS = X0 + np.array([[0, 0, 0, 0, 0], [0.01, 0, 1, 0, 0], [0, 0.02, -3, 2, 1]])


@needs_cuda
def test_the_stepper_with_its_tangents() -> None:
    records, names = arm_records((60, 45), "foh"), ("J", "k_g1", "F_c")
    asked = Pass(WINDOWS, P, STARTS, tangents=True)
    here = native(names=names).run(records, asked, substeps=2)
    there = EagerStepper.of(arm_with(P), names, "cuda", "double").run(records, asked, substeps=2)
    np.testing.assert_allclose(there.y, here.y, rtol=1e-10, atol=1e-10)
    assert here.dy is not None and there.dy is not None
    np.testing.assert_allclose(there.dy, here.dy, rtol=1e-6, atol=1e-10)


@needs_cuda
@pytest.mark.parametrize("adjoint", [False, True])
def test_torchdiffeq_and_its_adjoint(adjoint: bool) -> None:
    records, found = arm_records((60, 45)), {}
    for device in ("cpu", "cuda"):
        model = arm_with(P).to(device)
        x0 = torch.tensor(STARTS.T, device=device, requires_grad=True)
        outputs = solve(model, records, WINDOWS, x0, method="rk4", adjoint=adjoint)
        outputs.square().nanmean().backward()
        assert x0.grad is not None and outputs.device.type == device
        found[device] = (outputs.detach().cpu(), x0.grad.cpu(), float(model.raw["J"].grad))
    torch.testing.assert_close(found["cuda"][0], found["cpu"][0], rtol=1e-9, atol=1e-9)
    torch.testing.assert_close(found["cuda"][1], found["cpu"][1], rtol=1e-7, atol=1e-10)
    assert found["cuda"][2] == pytest.approx(found["cpu"][2], rel=1e-7)
