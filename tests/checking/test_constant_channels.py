"""Channels that never move are told once each; where no output moves at all, there is nothing to estimate from."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.constant_channels import constant_channels
from greybox_torch.data import DataSet, Recording
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems.load import load_model

MOVING: np.ndarray = np.sin(0.1 * np.arange(40))
STILL: np.ndarray = np.full(40, 22.0)


@pytest.fixture(scope="module")
def rotor(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'small.py'}:Rotor")


def data(*runs: tuple[np.ndarray, np.ndarray, Any]) -> DataSet:
    """Of voltage, speed and role of every experiment."""
    return DataSet(
        Recording.from_arrays(f"run {k}", {"voltage": u, "speed": y}, sample_time=0.01, role=role)
        for k, (u, y, role) in enumerate(runs)
    )


def test_a_stuck_output_is_told_once(rotor: GreyBoxModel) -> None:
    stuck = data((MOVING, STILL, "estimation"), (MOVING, STILL, "validation"))
    (told,) = data_warnings(stuck, rotor)
    assert str(told).startswith(
        'channel "speed" is constant (22) in experiments "run 0" and "run 1": an output that never moves says nothing'
    )


def test_an_output_that_is_stuck_in_validation_alone(rotor: GreyBoxModel) -> None:
    (told,) = constant_channels(data((MOVING, MOVING, "estimation"), (MOVING, STILL, "validation")), rotor)
    assert told.found.startswith('channel "speed" is constant (22) in experiment "run 1"')


def test_an_input_that_never_moves(rotor: GreyBoxModel) -> None:
    (told,) = constant_channels(data((0 * STILL, MOVING, "estimation"), (MOVING, MOVING, "validation")), rotor)
    assert told.found.startswith('channel "voltage" is constant (0) in experiment "run 0": an input that never moves')


@pytest.mark.parametrize("other", [MOVING, 0 * STILL])
def test_an_input_may_rest_in_one_experiment_or_differ_between_them(rotor: GreyBoxModel, other: np.ndarray) -> None:
    runs = data((STILL, MOVING, "estimation"), (other, MOVING, "estimation"), (STILL, MOVING, "validation"))
    assert list(constant_channels(runs, rotor)) == list(constant_channels(runs, None)) == []


def test_without_a_model() -> None:
    (told,) = gt.inspect(data((STILL, MOVING, "estimation"), (STILL, MOVING, "validation"))).warnings
    assert told.found.startswith(
        'channel "voltage" is constant (22) in experiments "run 0" and "run 1": nothing can be learned'
    )


@pytest.mark.parametrize("function", [gt.fit, gt.diagnose, gt.train])
@pytest.mark.parametrize(("other", "at"), [(STILL, "22"), (2 * STILL, "at a value of its own in each")])
def test_nothing_is_found_where_nothing_moves(
    rotor: GreyBoxModel, function: Callable[..., Any], other: np.ndarray, at: str
) -> None:
    runs = data((MOVING, STILL, "estimation"), (MOVING, other, "estimation"), (MOVING, MOVING, "validation"))
    message = f"recordings: no output moves in the experiments of role 'estimation' (speed: {at}, constant throughout)"
    with pytest.raises(gt.UserError, match=re.escape(message)):
        function(rotor, runs)
    assert message in str(gt.fit_many(rotor, [runs], return_exceptions=True)[0])


def test_many_experiments_are_not_all_named(rotor: GreyBoxModel) -> None:
    (told,) = constant_channels(data(*[(MOVING, STILL, role) for role in ("estimation", *7 * ["validation"])]), rotor)
    assert '"run 4" and 3 more: ' in told.found
