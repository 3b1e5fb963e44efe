"""Validation experiments in whose beginning nothing is measured."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.checking.late_sensors import late_sensors
from greybox_torch.data import InitialEntry
from tests.api.motor import Motor


def recorded(role: gt.Role, late: int) -> gt.Recording:
    speed = np.where(np.arange(200) < late, np.nan, np.linspace(0.0, 1.0, 200))
    signals = {"voltage": np.linspace(1.0, 2.0, 200), "speed": speed}
    return gt.Recording.from_arrays(
        role, signals, sample_time=0.01, role=role, units={"voltage": "V", "speed": "rad/s"}
    )


@pytest.mark.parametrize(("late", "told"), [(0, False), (19, False), (20, True), (60, True)])
def test_a_sensor_that_begins_late(late: int, told: bool) -> None:
    """Seen: a validation experiment was simulated from zero, and nothing said that no sample tells where it begins."""
    data = gt.DataSet([recorded("estimation", 60), recorded("validation", late)])
    found = list(late_sensors(data, Motor()))
    assert bool(found) is told
    assert (
        any("no output has a sample in its first tenth" in str(one) for one in gt.inspect(data, Motor()).warnings)
        is told
    )
    if told:
        assert f"the first one is {0.01 * late:.4g} s after the start" in found[0].found


def test_start_states_of_the_card_are_told() -> None:
    runs = [recorded("estimation", 0), recorded("validation", 60)]
    data = gt.DataSet(runs, initial={state.name: InitialEntry(value=0.5) for state in Motor().states})
    assert not list(late_sensors(data, Motor()))
