"""Every traced operation: value and symbolic derivative of the compiled code against torch and its autograd."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.stepper import Stepper
from greybox_torch.simulation.windows import Windows
from greybox_torch.systems import load_model

POINTS = 8
# Numbers that no kink of the operations lies on: there the derivative is a matter of taste.
hundredths = arrays(np.int64, POINTS, elements=st.integers(-200, 200)).map(lambda v: v / 100)
NO_DERIVATIVE_IN_TORCH = {"heaviside"}


@pytest.fixture(scope="module")
def model(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'operations.py'}:Operations")


@pytest.fixture(scope="module")
def stepper(model: GreyBoxModel) -> Stepper:
    stepper = make_stepper(model, ("c", "d"))
    assert isinstance(stepper, NativeStepper)
    return stepper


@settings(max_examples=100)
@given(a=hundredths, b=hundredths, u=hundredths, c=st.floats(0.3, 3.0), d=st.floats(-2.0, 2.0))
def test_value_and_derivative(
    model: GreyBoxModel, stepper: Stepper, a: np.ndarray, b: np.ndarray, u: np.ndarray, c: float, d: float
) -> None:
    x, p = np.array([a + 0.00123, b + 0.00456]), np.array([c, d])
    run = stepper.run(
        Records(u[None], np.zeros((1, POINTS)), np.ones(POINTS), np.array([0]), np.array([POINTS - 1]), ("",), "zoh"),
        Pass(
            Windows(np.arange(POINTS), np.arange(POINTS), 1),
            p,
            x.T,
            tangents=True,
            start_directions=np.broadcast_to(np.eye(2), (POINTS, 2, 2)),
        ),
    )
    assert run.dy is not None
    leaf_x = torch.tensor(x, requires_grad=True)
    leaf_p = torch.tensor(np.repeat(p[:, None], POINTS, axis=1), requires_grad=True)
    outputs = model.output(
        Signals("state", {"a": leaf_x[0], "b": leaf_x[1]}),
        Signals("input", {"u": torch.tensor(u)}),
        Signals("parameter", {"c": leaf_p[0], "d": leaf_p[1]}),
    )
    for k, (name, values) in enumerate(outputs.items()):
        expected = values.detach().expand(POINTS).numpy()
        np.testing.assert_allclose(run.y[:, 0, k], expected, rtol=1e-12, atol=1e-13, err_msg=name)
        if name not in NO_DERIVATIVE_IN_TORCH:
            slopes = _slopes(values, leaf_p, leaf_x)
            np.testing.assert_allclose(run.dy[:, 0, k], slopes, rtol=1e-9, atol=1e-10, err_msg=name)


def _slopes(values: torch.Tensor, *leaves: torch.Tensor) -> np.ndarray:
    """Derivatives (W, 4) with respect to the parameters, then the states."""
    if not values.requires_grad:
        return np.zeros((POINTS, 4))
    found = torch.autograd.grad(values.sum(), leaves, retain_graph=True, allow_unused=True)
    return torch.cat(
        [torch.zeros_like(leaf) if g is None else g for g, leaf in zip(found, leaves, strict=True)]
    ).T.numpy()


def test_power_of_zero_has_a_slope_in_its_exponent(model: GreyBoxModel, stepper: Stepper) -> None:
    records = Records(np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.array([0]), np.array([0]), ("",), "zoh")
    run = stepper.run(
        records, Pass(Windows(np.array([0]), np.array([0]), 1), np.array([2.0, 0.0]), np.zeros((1, 2)), tangents=True)
    )
    assert run.dy is not None
    row = [output.name for output in model.outputs].index("power_parameter")
    assert run.dy[0, 0, row, 0] == 0.0


def test_exponentials_of_very_negative_numbers_are_zero_as_anywhere(machines: Path) -> None:
    """The compiled code does not ask the vector library about them, which takes its time for numbers that are not normal."""
    exponents = np.array([-1e300, -800.0, -708.5, -707.9, -87.5, -1.0, 0.0, 700.0, 800.0, np.inf, -np.inf, np.nan])
    stepper = make_stepper(load_model(f"{machines / 'operations.py'}:Exponential"), ("k",))
    count = len(exponents)
    records = Records(
        exponents[None], np.zeros((1, count)), np.ones(count), np.array([0]), np.array([count - 1]), ("",), "zoh"
    )
    at = np.arange(count)
    run = stepper.run(records, Pass(Windows(at, at, 1), np.array([1.0]), np.zeros((count, 1)), tangents=True))
    assert isinstance(stepper, NativeStepper) and run.dy is not None
    with np.errstate(over="ignore", invalid="ignore"):
        values, slopes = np.exp(exponents), exponents * np.exp(exponents)
    np.testing.assert_allclose(run.y[:, 0, 0], values, rtol=1e-14, atol=1e-300)
    np.testing.assert_allclose(run.dy[3:8, 0, 0, 0], slopes[3:8], rtol=1e-14)
    np.testing.assert_array_equal(run.dy[:3, 0, 0, 0], 0.0)
