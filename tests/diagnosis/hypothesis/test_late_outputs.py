"""What an output with a dead time shows first is from before the record: windows do not count it."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.fit import augmented
from greybox_torch.diagnosis.hypothesis.window_errors import window_errors
from greybox_torch.estimate.problem import problem_for
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.sensor import OutputDelay, SensorLag

STEP = 0.01


@pytest.fixture(scope="module")
def search(motor_data, motor, begun):
    return begun(motor_data(), motor)


def with_law(search, motor, law, time: float):
    effect = attach(motor, "sensor", law)
    model = augmented(search.problem, (effect,), search.surroundings)
    return problem_for(search.problem, model, {f"{effect.prefix}.T": time})


@pytest.mark.parametrize("time", [0.05, 0.2])
def test_two_dead_times_are_not_counted_where_a_record_begins(search, motor, time) -> None:
    problem = with_law(search, motor, OutputDelay(), time)
    counted, own = problem.window_records, problem.records
    for e in range(len(own.first)):
        begun = own.time(e) - own.time(e)[0] >= 2 * time
        np.testing.assert_array_equal(np.isnan(counted.y[0, own.span(e)]), ~begun)
        np.testing.assert_array_equal(counted.y[0, own.span(e)][begun], own.y[0, own.span(e)][begun])
    np.testing.assert_array_equal(counted.u, problem.driving_records.u)


def test_nothing_is_lost_to_other_laws(search, motor) -> None:
    assert with_law(search, motor, SensorLag(), 0.05).window_records.y is search.problem.records.y
    assert search.problem.window_records is search.problem.records


def test_the_mean_square_is_over_the_samples_that_are_counted(search, motor) -> None:
    fitted = search.refitted((attach(motor, "sensor", OutputDelay()),), search.plain)
    for fit in fitted.fits:
        errors = window_errors(fit, fitted.simulator)
        assert np.isnan(errors[0, 0]) and np.isfinite(errors[0, -1])
        windows = [errors[:, a : b + 1] for a, b in zip(fit.windows.start, fit.windows.last, strict=True)]
        left = [(w * fit.problem.weights[:, None]) ** 2 for w in windows]
        samples = sum(int(np.isfinite(w).sum()) for w in left)
        assert fit.mean_square == pytest.approx(sum(float(np.nansum(w)) for w in left) / samples, rel=1e-3)
