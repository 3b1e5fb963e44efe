"""The noise of a recording, from the recording alone."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import make_problem

MISSING = 0.3


@pytest.mark.parametrize("noise", [0.1, 0.3])
def test_white_noise_on_a_smooth_motion(motor_data, motor, noise) -> None:
    data = motor_data(noise=noise)
    problem = make_problem(data, motor, data.recordings)
    assert noise_floor(problem, DiagnosisSettings()) == pytest.approx(noise**2, rel=0.1)


def test_missing_samples_are_left_out(motor_data, motor) -> None:
    data = motor_data(noise=0.1)
    problem = make_problem(data, motor, data.recordings)
    holes = np.random.default_rng(0).random(problem.records.y.shape) < MISSING
    problem.records.y[holes] = np.nan
    assert noise_floor(problem, DiagnosisSettings()) == pytest.approx(0.01, rel=0.15)


def test_experiments_are_not_joined(motor_data, motor) -> None:
    """A step from the end of one to the start of the next is not noise."""
    data = motor_data(noise=0.1)
    problem = make_problem(data, motor, data.recordings)
    problem.records.y[:, problem.records.span(1)] += 1000.0
    assert noise_floor(problem, DiagnosisSettings()) == pytest.approx(0.01, rel=0.1)
