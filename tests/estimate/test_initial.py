"""Start states from the first tenth of a record."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import Simulator
from tests.estimate.bench_motor import UNITS, problem_of


def test_start_states_from_the_first_tenth(motor: GreyBoxModel, motor_speed: Any, data_set: Any) -> None:
    """The first tenth decides, whatever the rest of the record says, and parameters are left alone."""
    voltage = np.zeros(300)
    speed = motor_speed(voltage, start=3.0)
    speed[30:] = 99.0
    data = data_set(UNITS, [{"voltage": voltage, "speed": speed}], initial={"speed": {"value": 0.0}})
    problem = problem_of(data, motor).with_values(np.array([0.02, 0.1, 0.05]))
    found = estimate_initial(problem, Simulator.of(motor, ()))
    assert found.initial[0, 0] == pytest.approx(3.0, rel=1e-6)
    assert found.values.tolist() == [0.02, 0.1, 0.05]
    fixed = estimate_initial(replace(problem, initial_free=np.zeros(1, dtype=bool)), Simulator.of(motor, ()))
    assert fixed.initial[0, 0] == 0.0


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_sensor_that_begins_behind_the_first_tenth(motor: GreyBoxModel, motor_speed: Any, data_set: Any) -> None:
    """Seen: an index error of `fit`; the start state stays as it was given where no sample tells it."""
    voltage = np.zeros(300)
    speed = motor_speed(voltage, start=3.0)
    speed[:60] = np.nan
    data = data_set(UNITS, [{"voltage": voltage, "speed": speed}], initial={"speed": {"value": 2.0}})
    problem = problem_of(data, motor).with_values(np.array([0.02, 0.1, 0.05]))
    assert estimate_initial(problem, Simulator.of(motor, ())).initial[0, 0] == pytest.approx(2.0)
