"""States along recordings from the sensors alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.estimate.averaging import stretches
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.reconstruction import MOST_INTERVALS, Motion, reconstructed
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import RobotArm
from greybox_torch.systems.load import load_model


@pytest.fixture(scope="module")
def sled(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'sled.py'}:Sled")


@pytest.fixture(scope="module")
def problem(sled, sled_run):
    data = sled_run()
    return make_problem(data, sled, data.estimation())


def motion_of(problem) -> Motion:
    found = reconstructed(problem)
    assert isinstance(found, Motion)
    return found


def true_speed(e: int, t: np.ndarray) -> np.ndarray:
    waves = [(0.30, 2.1 + 0.3 * e, 0.4), (0.12, 5.3, 1.0 + e), (0.02, 11.7, 0.2)]
    return np.sum([a * w * np.cos(w * t + f) for a, w, f in waves], axis=0)


def test_the_speed_behind_a_measured_position_is_that_of_the_motion(problem) -> None:
    motion = motion_of(problem)
    assert motion.shown.all()
    for e in (0, 1):
        own = motion.experiment == e
        true = true_speed(e, motion.time[own])
        assert np.std(motion.states[1, own] - true) < 3e-3 * np.std(true)
        assert motion.rates[0, own] == pytest.approx(true, abs=0.05), "by differences of the position itself"


def test_intervals_are_no_shorter_than_what_the_noise_leaves_of_the_motion(problem) -> None:
    motion = motion_of(problem)
    assert 0.0 < motion.cutoff <= 0.5
    assert len(motion.dt) < problem.records.y.shape[1]
    assert len(motion.dt) <= MOST_INTERVALS


def test_intervals_beside_a_gap_are_not_known(problem) -> None:
    y = problem.records.y.copy()
    y[0, 1000:1010] = np.nan
    motion = motion_of(replace(problem, records=replace(problem.records, y=y)))
    lost = motion.time[~motion.known & (motion.experiment == 0)]
    assert lost.min() < 2.0 < 2.018 < lost.max()
    assert motion.known[motion.experiment == 1].all()
    assert np.isfinite(motion.states).all()


@pytest.mark.parametrize(
    ("y", "why"),
    [
        (np.full((1, 8000), 0.2), "does not stand above its noise"),
        (np.full((1, 8000), np.nan), "is missing throughout"),
    ],
)
def test_what_sensors_do_not_show_is_said(problem, y: np.ndarray, why: str) -> None:
    found = reconstructed(replace(problem, records=replace(problem.records, y=y)))
    assert isinstance(found, str)
    assert why in found


def test_of_an_arm_with_one_sensor_the_hidden_states_are_named(data_set) -> None:
    n = 200
    data = data_set({"torque": "N m", "motor_speed": "rad/s"}, [{"torque": np.zeros(n), "motor_speed": np.arange(n)}])
    found = reconstructed(make_problem(data, RobotArm(), data.estimation()))
    assert isinstance(found, str)
    assert "gear_twist, arm_twist, gearbox_speed, arm_speed" in found


def test_stretches_keep_what_is_constant_and_stay_within_experiments(problem) -> None:
    motion = motion_of(problem)
    finest = stretches(motion)
    coarser = finest.coarser(4)
    ramp = np.arange(len(motion.dt), dtype=float)
    for some, signal in ((finest, ramp), (coarser, finest.mean(ramp))):
        assert some.mean(np.ones(len(signal))) == pytest.approx(1.0)
        assert some.mean(signal) == pytest.approx(ramp[some.middle], abs=1e-6)
    assert coarser.count < finest.count / 3
    assert (motion.experiment[finest.index] == finest.experiment[:, None]).all()
    assert (finest.experiment[coarser.index] == coarser.experiment[:, None]).all()


def test_no_stretch_has_a_gap_in_it(problem) -> None:
    motion = motion_of(problem)
    known = motion.known.copy()
    known[200:203] = False
    holed = replace(motion, known=known)
    finest = stretches(holed)
    assert holed.known[finest.index].all()
    spans = finest.middle[finest.coarser(4).index]
    assert not ((spans.min(axis=1) < 200) & (spans.max(axis=1) > 202)).any()
