"""Laws over time where a signal goes one way along every recording."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.select.told_from_time import limited_by_time
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.simulation.records import Records

SETTINGS, LENGTHS = DiagnosisSettings(), (200, 120)
FIRST = np.array([0, LENGTHS[0]])
TIME = np.concatenate([0.5 * np.arange(n) for n in LENGTHS])
COASTING = np.concatenate([20.0 * np.exp(-t / 30.0) for t in (TIME[:200], TIME[200:])])
RECORDS = Records(
    np.zeros((1, 320)), np.zeros((1, 320)), np.full(320, 0.5), FIRST, FIRST + np.array(LENGTHS) - 1, ("a", "b"), "zoh"
)


def test_of_a_machine_that_coasts_down_time_and_speed_are_not_told_apart() -> None:
    limit = limited_by_time({"speed": COASTING, "time": TIME}, RECORDS, SETTINGS)
    assert limit is not None
    assert limit.highest == 0.5
    assert limit.why == "along every recording speed goes one way with time: a law of speed may be meant"


def test_one_recording_that_goes_both_ways_tells_them_apart() -> None:
    speed = COASTING.copy()
    speed[200:] = np.sin(TIME[200:])
    assert limited_by_time({"speed": speed, "time": TIME}, RECORDS, SETTINGS) is None


def test_laws_that_time_is_no_part_of_are_not_concerned() -> None:
    assert limited_by_time({"speed": COASTING}, RECORDS, SETTINGS) is None
    assert limited_by_time({"speed": np.zeros(320), "time": TIME}, RECORDS, SETTINGS) is None
