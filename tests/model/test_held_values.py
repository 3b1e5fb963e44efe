"""The values that a model object holds: which of them stand before a data card, and copies that hold others."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch import load_dataset, load_model
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import make_problem
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.model import GreyBoxModel, Parameter
from greybox_torch.model.copies import copy_holding

Make = Callable[..., Path]


@pytest.fixture
def motor(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines}/motor.py:Motor")


def values(model: GreyBoxModel, folder: Path) -> dict[str, float]:
    data = load_dataset(folder / "dataset.toml")
    problem = make_problem(data, model, data.recordings)
    return dict(zip(problem.names, map(float, problem.values), strict=True))


def test_a_card_stands_before_what_is_declared(motor: GreyBoxModel, motor_folder: Make) -> None:
    assert motor.held_values() == {}
    assert values(motor, motor_folder()) == {"J": 0.03, "k": 0.1, "b": 0.08}


def test_what_was_set_stands_before_the_card(motor: GreyBoxModel, motor_folder: Make) -> None:
    motor.set_values({"J": 0.0123})
    assert values(motor, motor_folder()) == {"J": 0.0123, "k": 0.1, "b": 0.08}


def test_set_to_what_is_declared(motor: GreyBoxModel, motor_folder: Make) -> None:
    declared = motor.values()["J"]
    motor.set_values({"J": declared})
    assert values(motor, motor_folder())["J"] == declared != 0.03


@pytest.mark.parametrize("value", ["3", None, [3.0]])
def test_what_is_no_number_is_refused(motor: GreyBoxModel, value: Any) -> None:
    with pytest.raises(UserError, match=r"parameter 'J' of model Motor: found .*, expected a number"):
        motor.set_values({"J": value})


def test_what_an_optimiser_has_moved(motor: GreyBoxModel) -> None:
    optimiser = torch.optim.SGD([motor.raw["J"]], lr=0.1)
    motor.physical().J.backward()
    optimiser.step()
    assert list(motor.held_values()) == ["J"]


def test_outside_of_the_cards_bounds(motor: GreyBoxModel, motor_folder: Make) -> None:
    motor.set_values({"b": 3.0})
    data = load_dataset(motor_folder() / "dataset.toml")
    problem = make_problem(data, motor, data.recordings)
    assert (problem.values[2], problem.lower[2], problem.upper[2]) == (3.0, 0.0, 3.0)


@given(value=st.floats(1e-9, 1e9))
def test_no_digit_is_lost(machines: Path, value: float) -> None:
    model = load_model(f"{machines}/motor.py:Motor")
    model.set_values({"J": value})
    assert model.values()["J"] == value


def test_a_copy_with_effects(motor: GreyBoxModel) -> None:
    around = Surroundings({"speed": Range(-1.0, 1.0, 0.5)}, {"speed": "rad/s"}, "N m", 0.01)
    model = AugmentedModel(motor, [Attachment("rotor", ConstantBias())], {"rotor": around})
    (bias,) = set(model.values()) - set(motor.values())
    inertia = Parameter("J", 0.2, lower=0.1, upper=0.4, fixed=True)
    made = copy_holding(model, {"J": 0.5, bias: 0.25}, declared=[inertia], starts_free=True)
    assert isinstance(made, AugmentedModel)
    assert (made.values()["J"], made.values()[bias], made.base.values()["J"]) == (0.5, 0.25, 0.5)
    assert made.declared_parameters[0].bounds == (0.1, 0.5)
    assert made.declared_parameters[0].fixed
    assert made.starts_free and made.plain is made.base
    assert not model.starts_free and model.held_values() == motor.held_values() == {}
