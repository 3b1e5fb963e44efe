from __future__ import annotations

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.model import GreyBoxModel, Output, Parameter, State
from greybox_torch.model.constraints import parameter_scale, project

INFINITE = float("inf")
numbers = st.floats(-1e6, 1e6).map(lambda v: round(v, 9))


def one_parameter(value: float, lower: float | None, upper: float | None) -> GreyBoxModel:
    class Model(GreyBoxModel):
        states = [State("x")]
        outputs = [Output("x")]
        parameters = [Parameter("k", value, lower=lower, upper=upper)]

    return Model()


@given(raw=numbers, bounds=st.tuples(numbers, numbers).filter(lambda pair: pair[0] < pair[1]))
def test_project_holds_within_bounds(raw: float, bounds: tuple[float, float]) -> None:
    held = project(torch.tensor(raw, dtype=torch.float64), *bounds)
    assert float(held) == min(max(raw, bounds[0]), bounds[1])


@pytest.mark.parametrize(
    ("raw", "slope", "expected"),
    [
        (0.0, -1.0, -1.0),  # at the lower bound, descent leads inwards
        (0.0, 1.0, 0.0),  # … and outwards
        (1.0, 1.0, 1.0),  # at the upper bound, inwards
        (1.0, -1.0, 0.0),  # … and outwards
        (-0.5, -1.0, -1.0),  # beyond a bound, back
        (-0.5, 1.0, 0.0),
        (0.5, 1.0, 1.0),  # inside, untouched
        (0.5, -1.0, -1.0),
    ],
)
def test_gradient_at_bounds(raw: float, slope: float, expected: float) -> None:
    leaf = torch.tensor(raw, dtype=torch.float64, requires_grad=True)
    (slope * project(leaf, 0.0, 1.0)).backward()
    assert leaf.grad is not None
    assert float(leaf.grad) == expected


def test_without_bounds_nothing_is_done() -> None:
    leaf = torch.tensor(3.0, requires_grad=True)
    assert project(leaf, -INFINITE, INFINITE) is leaf


def test_gradient_of_a_batch() -> None:
    raw = torch.tensor([-1.0, 0.0, 0.5, 1.0, 2.0], dtype=torch.float64, requires_grad=True)
    project(raw, 0.0, 1.0).sum().backward()
    assert raw.grad is not None
    assert raw.grad.tolist() == [0.0, 0.0, 1.0, 1.0, 1.0]


@pytest.mark.parametrize(
    ("value", "bounds", "scale"),
    [
        (20.0, (0.0, INFINITE), 16.0),
        (-3.0, (-INFINITE, INFINITE), 2.0),
        (0.0, (0.0, 5.0), 4.0),
        (0.125, (0.0, INFINITE), 0.125),
        (0.0, (0.0, INFINITE), 1.0),
    ],
)
def test_scale(value: float, bounds: tuple[float, float], scale: float) -> None:
    assert parameter_scale(value, *bounds) == scale


@given(
    st.tuples(numbers, numbers, numbers).map(sorted).filter(lambda t: t[0] < t[2]),
    st.floats(0.0, 1.0),
)
def test_a_value_within_its_bounds_comes_back(three: list[float], share: float) -> None:
    lower, start, upper = three
    model = one_parameter(start, lower, upper)
    assert model.values()["k"] == start
    for value in (lower, upper, lower + share * (upper - lower)):
        value = min(max(value, lower), upper)
        model.set_values({"k": value})
        found = model.values()["k"]
        assert found == pytest.approx(value, rel=1e-14, abs=1e-300)
        assert lower <= found <= upper


def test_learns_from_a_start_at_its_bound() -> None:
    """A parameter that starts at zero, its lower bound, moves to where the loss wants it, and stops at the bound if not."""
    for wanted, reached in ((0.7, 0.7), (-0.7, 0.0)):
        model = one_parameter(0.0, 0.0, None)
        optimiser = torch.optim.SGD(torch.nn.Module.parameters(model), lr=0.1)
        for _ in range(200):
            optimiser.zero_grad()
            loss = (model.physical().k - wanted) ** 2
            loss.backward()
            optimiser.step()
        assert model.values()["k"] == pytest.approx(reached, abs=1e-6)


def test_fixed_parameters_take_no_gradient() -> None:
    class Model(GreyBoxModel):
        states = [State("x")]
        outputs = [Output("x")]
        parameters = [Parameter("k", 1.0), Parameter("m", 2.0, fixed=True)]

    learnable = {name for name, raw in Model().named_parameters() if raw.requires_grad}
    assert learnable == {"raw.k"}
