from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greybox_torch.data import DataSet, Recording
from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel, Input, Output, State
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import make_records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.substeps import choose_substeps
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems import load_model

NAN = float("nan")
UNITS = {"voltage": "V", "speed": "rad/s"}


@pytest.fixture(scope="module")
def motor(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'motor.py'}:Motor")


def test_experiments_end_to_end(motor: GreyBoxModel, data_set: Any) -> None:
    data = data_set(
        UNITS,
        [
            {"voltage": [1.0, 2.0, 3.0], "speed": [4.0, 5.0, 6.0]},
            {"voltage": [7.0, 8.0], "speed": [9.0, 10.0], "time": [5.0, 5.5]},
        ],
    )
    records = make_records(data, motor, data.recordings)
    assert records.u.tolist() == [[1.0, 2.0, 3.0, 7.0, 8.0]]
    assert records.y.tolist() == [[4.0, 5.0, 6.0, 9.0, 10.0]]
    assert records.first.tolist() == [0, 3]
    assert records.last.tolist() == [2, 4]
    assert records.lengths.tolist() == [3, 2]
    np.testing.assert_allclose(records.dt, [0.01, 0.01, 0.01, 0.5, 0.5])
    np.testing.assert_allclose(records.time(1), [0.0, 0.5])


def test_missing_inputs_are_held_and_missing_outputs_stay(motor: GreyBoxModel, data_set: Any) -> None:
    data = data_set(UNITS, [{"voltage": [NAN, NAN, 1.0, NAN, 2.0], "speed": [NAN, 1.0, NAN, 2.0, NAN]}])
    records = make_records(data, motor, data.recordings)
    assert records.u.tolist() == [[1.0, 1.0, 1.0, 1.0, 2.0]]
    np.testing.assert_array_equal(records.y, [[NAN, 1.0, NAN, 2.0, NAN]])


@pytest.mark.parametrize("unit", ["rad/s", "", "RAD / s"])
def test_ways_to_write_a_unit(motor: GreyBoxModel, data_set: Any, unit: str) -> None:
    data = data_set({"voltage": "V", "speed": unit}, [{"voltage": np.zeros(3), "speed": np.zeros(3)}])
    make_records(data, motor, data.recordings)


@pytest.mark.parametrize(
    ("units", "message"),
    [
        (
            {"voltage": "V", "spede": "rad/s"},
            "[channels] has no 'speed', which model Motor needs; found: voltage, spede",
        ),
        ({"voltage": "V", "speed": "rpm"}, "[channels] speed: unit is 'rpm', model Motor expects 'rad/s'"),
        (
            {"voltage": "mV", "speed": "rpm"},
            "[channels]: 2 problems:\n  voltage: unit is 'mV', model Motor expects 'V'",
        ),
        (
            {**UNITS, "torque": "N m"},
            "[channels] torque: model Motor has no such signal; expected one of voltage, speed",
        ),
    ],
)
def test_channels_that_are_not_the_models(
    motor: GreyBoxModel, data_set: Any, units: dict[str, str], message: str
) -> None:
    data = data_set(units, [{name: np.zeros(3) for name in units}])
    with pytest.raises(UserError, match=re.escape(f"dataset.toml: {message}")):
        make_records(data, motor, data.recordings)


@pytest.mark.parametrize(
    ("unit", "told"),
    [
        ("rpm", 'multiply those of "speed" by 0.104719755, and write units={"speed": "rad/s"}'),
        ("rmp", 'did you mean "rpm"?'),
        ("Hz", "expected values and unit of the model"),
    ],
)
def test_values_of_python_in_another_unit(motor: GreyBoxModel, unit: str, told: str) -> None:
    """Seen: "expected values and unit of the model", and no word of how to come there."""
    signals = {"voltage": np.ones(20), "speed": np.ones(20)}
    data = DataSet([Recording.from_arrays("run", signals, sample_time=0.1, units={"speed": unit})])
    with pytest.raises(UserError, match=re.escape(told)):
        make_records(data, motor, data.recordings)


def test_a_model_in_multiples_of_gravity_that_are_written_as_grams() -> None:
    """Seen: "expected a column whose values are in g", and not a word that g is the gram."""
    sensor = type(
        "Sensor", (GreyBoxModel,), {"outputs": (Output("a", "g"),), "output": lambda self, x, u, p: {"a": 0.0 * u.u}}
    )
    sensor.inputs, sensor.states, sensor.derivative = (
        (Input("u"),),
        (State("x"),),
        lambda self, x, u, p, port: {"x": u.u},
    )
    signals = {"u": np.ones(20), "a": np.ones(20)}
    data = DataSet([Recording.from_arrays("run", signals, sample_time=0.1, units={"a": "m/s^2"})])
    with pytest.raises(UserError, match=r'multiples of gravity are "g0"'):
        make_records(data, sensor(), data.recordings)


@pytest.mark.parametrize("inertia", [0.1, 1e-3, 2e-4, 2e-5])
def test_substeps_are_as_few_as_accuracy_allows(motor: GreyBoxModel, data_set: Any, inertia: float) -> None:
    """With b = 0.1 the time constant is J / b; a step of 10 ms is short, long, or far beyond what is stable."""
    voltage = np.sign(np.sin(0.1 * np.arange(300)))
    data = data_set(UNITS, [{"voltage": voltage, "speed": voltage}])
    records, stepper, p = (
        make_records(data, motor, data.recordings),
        make_stepper(motor, ()),
        np.array([inertia, 0.1, 0.1]),
    )
    exact, decay = [0.0], np.exp(-0.1 * 0.01 / inertia)
    for v in voltage[:-1]:
        exact.append(decay * exact[-1] + (1 - decay) * v)

    def error(substeps: int) -> float:
        run = stepper.run(records, Pass(whole_records(records), p, np.zeros((1, 1))), substeps=substeps)
        return float(np.sqrt(np.mean((run.y[0, :, 0] - exact) ** 2))) if np.isfinite(run.y).all() else np.inf

    chosen = choose_substeps(records, stepper, p, np.zeros((1, 1)), tolerance=3e-4)
    assert chosen is not None
    assert error(chosen) < 4e-4
    assert chosen == 1 or error(chosen // 2) > 3e-4


def test_substeps_where_no_number_is_enough(motor: GreyBoxModel, data_set: Any) -> None:
    data = data_set(UNITS, [{"voltage": np.ones(300), "speed": np.arange(300.0)}])
    records = make_records(data, motor, data.recordings)
    assert choose_substeps(records, make_stepper(motor, ()), np.array([1e-9, 0.1, 0.1]), np.zeros((1, 1))) is None
