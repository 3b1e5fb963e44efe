"""Which times of effects are dead times."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.describe.report_data import times_of
from tests.diagnosis.test_verdict import BACKLASH


def test_dead_times_are_told_from_other_times() -> None:
    late, slow = ({"T": {"value": value, "std": 0.1, "unit": "s"}} for value in (2.0, 30.0))
    delay = replace(BACKLASH, port="P", mechanism="input_delay", parameters=late)
    lag = replace(BACKLASH, port="P", mechanism="input_lag", parameters=slow)
    assert times_of([delay, lag, BACKLASH]) == ({"T of input delay at P": 2.0}, {"T of input lag at P": 30.0})
