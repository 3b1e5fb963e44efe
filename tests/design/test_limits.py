"""What a recording may do: from the table, else from what was recorded."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.errors import UserError
from greybox_torch.experiment_design.excitation import Excitation
from greybox_torch.experiment_design.limits import held_as_in, limits_of


@pytest.fixture(scope="module")
def motor(machines: Path):
    spec = importlib.util.spec_from_file_location("motor_for_limits", machines / "motor.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Motor()


@pytest.fixture
def data(data_set):
    time = 0.01 * np.arange(300)
    return data_set({"voltage": "V", "speed": "rad/s"}, [{"voltage": 3 * np.sin(time), "speed": 10 * np.sin(time)}] * 2)


def test_what_was_recorded_is_the_default(data, motor) -> None:
    found = limits_of(data, motor, {}, "[limits]")
    assert found.seconds == pytest.approx(3.0)
    voltage, speed = found.inputs["voltage"], found.outputs["speed"]
    assert (voltage.upper, voltage.rate) == (pytest.approx(3.0, rel=1e-3), np.inf)
    assert speed.upper > 10.0 and speed.lower < data.recordings[0].signals["speed"].min()


@pytest.fixture
def constant(data_set):
    """Another voltage in each recording, interpolated: constant but for rounding."""
    time = 0.01 * np.arange(300)
    own = [{"voltage": v + 1e-16 * np.sin(time), "speed": 10 * np.sin(time)} for v in (0.9, 1.3)]
    return data_set({"voltage": "V", "speed": "rad/s"}, own)


def test_an_input_that_was_constant_is_kept_so(constant, motor) -> None:
    """Seen: a rope's length, 0.9 m in one recording and 1.3 m in another, that was to move with 2 Hz."""
    found = limits_of(constant, motor, {"voltage": {"rate": 2.0}}, "[limits]")
    assert found.held == ("voltage",) and found.designed == [] and "voltage" not in found.recorded
    at = held_as_in(found, constant.recordings[1], 0.01).inputs["voltage"]
    assert at.lower == at.upper == pytest.approx(1.3) and at.rate == 2.0
    free = limits_of(constant, motor, {"voltage": {"lower": 0.5}}, "[limits]")
    assert free.held == () and free.inputs["voltage"].upper == pytest.approx(1.3) and free.designed == ["voltage"]


def test_one_value_is_a_range_of_an_input(data, motor) -> None:
    found = limits_of(data, motor, {"voltage": {"lower": 2, "upper": 2}}, "[limits]")
    assert (found.inputs["voltage"].half, found.inputs["voltage"].middle, found.designed) == (0.0, 2.0, [])
    moved = Excitation("steps", 0.5, 2.0, 0.4, 0.7, 1).sampled(0.01 * np.arange(100), found.inputs["voltage"])
    assert (moved == 2.0).all()


def test_what_the_table_says(data, motor) -> None:
    table = {"seconds": 5, "voltage": {"lower": -1, "upper": 2, "rate": 40}, "speed": {"upper": 50.0}}
    found = limits_of(data, motor, table, "[limits]")
    assert found.seconds == 5.0
    assert (found.inputs["voltage"].lower, found.inputs["voltage"].middle, found.inputs["voltage"].rate) == (
        -1,
        0.5,
        40,
    )
    assert found.outputs["speed"].upper == 50.0
    assert limits_of(data, motor, {"seconds": np.int64(5)}, "[limits]").seconds == 5.0


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"volts": {}}, r'\[limits\] volts: no input, output or state is named so \(did you mean "voltage"'),
        ({"seconds": 0}, r"\[limits\] seconds: found 0, expected a number above zero"),
        ({"seconds": "long"}, r"found 'long', expected a number"),
        ({"voltage": 3}, r"\[limits\] voltage: found 3; expected \{ lower"),
        ({"voltage": {"most": 3}}, r'expected \{ lower .* or some of these, or "recorded"'),
        ({"voltage": {"lower": 2, "upper": 1}}, r"lower = 2 is not below upper = 1"),
        ({"speed": {"lower": 2, "upper": 2}}, r"lower = 2 is not below upper = 2; expected a range"),
        ({"voltage": {"rate": -1}}, r"voltage, rate: found -1, expected a number above zero"),
        ({"speed": {"upper": True}}, r"speed, upper: found True, expected a number"),
    ],
)
def test_what_cannot_be_a_limit(data, motor, table, message) -> None:
    with pytest.raises(UserError, match=message):
        limits_of(data, motor, table, "[limits]")
