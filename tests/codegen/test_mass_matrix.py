"""A two-link arm with its mass matrix as textbooks write it is compiled, and gives what the form solved by hand gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.codegen.arrays import UnsupportedOperation
from greybox_torch.codegen.lower import lower
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.stepper import Stepper
from greybox_torch.simulation.windows import whole_records

STEPS = 25
START = np.array([[0.3, -0.5, 0.0, 0.2]])


@pytest.fixture(scope="module")
def textbook(machines: Path) -> gt.GreyBoxModel:
    return gt.load_model(f"{machines / 'two_link.py'}:TwoLink")


@pytest.fixture(scope="module")
def by_hand(machines: Path) -> gt.GreyBoxModel:
    return gt.load_model(f"{machines / 'two_link.py'}:TwoLinkByHand")


def run(stepper: Stepper, values: np.ndarray, tangents: bool = True) -> Run:
    time = 0.02 * np.arange(STEPS)
    u = np.array([2.0 * np.sin(3 * time), np.cos(5 * time)])
    records = Records(u, np.zeros((2, STEPS)), np.full(STEPS, 0.02), np.array([0]), np.array([STEPS - 1]), ("",), "zoh")
    asked = Pass(whole_records(records), values, START, tangents=tangents, start_directions=np.eye(4)[None])
    return stepper.run(records, asked, 2)


def names_of(model: gt.GreyBoxModel) -> list[str]:
    return [p.name for p in model.declared_parameters]


def test_both_forms_are_compiled_to_the_same_numbers(textbook: gt.GreyBoxModel, by_hand: gt.GreyBoxModel) -> None:
    values = np.array(list(textbook.values().values()))
    steppers = [make_stepper(model, names_of(model)) for model in (textbook, by_hand)]
    assert all(isinstance(stepper, NativeStepper) for stepper in steppers)
    one, other = (run(stepper, values) for stepper in steppers)
    np.testing.assert_allclose(one.y, other.y, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(one.dy, other.dy, rtol=1e-9, atol=1e-11)


def test_both_routes_agree(textbook: gt.GreyBoxModel) -> None:
    values = np.array(list(textbook.values().values()))
    names = names_of(textbook)
    compiled, eager = make_stepper(textbook, names), EagerStepper.of(textbook, names, "cpu", "double")
    one, other = run(compiled, values), run(eager, values)
    np.testing.assert_allclose(one.y, other.y, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(one.dy, other.dy, rtol=1e-9, atol=1e-11)


def test_gradients_against_finite_differences(textbook: gt.GreyBoxModel) -> None:
    values = np.array(list(textbook.values().values()))
    stepper = make_stepper(textbook, names_of(textbook))
    dy = run(stepper, values).dy
    assert dy is not None
    for k, value in enumerate(values):
        step = 1e-5 * max(abs(value), 0.1)
        up, down = (run(stepper, values + sign * step * np.eye(len(values))[k], False).y for sign in (1, -1))
        slope = (up - down) / (2 * step)
        np.testing.assert_allclose(dy[..., k], slope, rtol=1e-6, atol=1e-7 * np.abs(slope).max())


def test_a_matrix_may_hold_numbers_that_are_alike_for_all_samples(textbook: gt.GreyBoxModel) -> None:
    """An element of parameters alone has the shape of the others, wherever the model is looked at."""
    assert textbook.carried_states() == ()
    x, u = torch.zeros(4, 5, 3, dtype=torch.float64), torch.zeros(2, 5, 3, dtype=torch.float64)
    with torch.no_grad():
        assert textbook.rates(x, u, textbook.physical()).shape == (4, 5, 3)


def test_it_is_sound_and_its_units_fit(textbook: gt.GreyBoxModel) -> None:
    assert gt.check(textbook).findings == ()


def test_systems_that_are_too_large_are_not_written_out() -> None:
    class Large(gt.GreyBoxModel):
        states, outputs = [gt.State("a")], [gt.Output("a")]

        def derivative(self, x, u, p, port):
            matrix = torch.eye(7, dtype=torch.float64) * (1 + x.a[..., None, None] ** 2)
            return {
                "a": torch.linalg.solve(matrix, torch.ones(7, dtype=torch.float64).expand(matrix.shape[:-1]))[..., 0]
            }

        def output(self, x, u, p):
            return {"a": x.a}

    with pytest.raises(UnsupportedOperation, match="more than 6 equations"):
        lower(Large(), ())
    assert not gt.check(Large()).compiled
    assert gt.check(Large()).usable
