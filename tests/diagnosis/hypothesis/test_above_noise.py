"""Whether anything is left above the noise."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.hypothesis.above_noise import only_noise
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()


@pytest.mark.parametrize(("torque", "expected"), [(None, True), (lambda q, v: -0.004 * v * abs(v), False)])
def test_nothing_is_looked_for_below_the_noise(motor_data, motor, begun, torque, expected) -> None:
    search = begun(motor_data(torque=torque, noise=0.1), motor)
    assert only_noise(search.problem, search.plain, SETTINGS) == expected


def test_noise_is_not_known_where_the_motion_is_rough(motor_data, motor, begun) -> None:
    """Differences of several orders do not agree: nothing says that this little error is only noise."""
    search = begun(motor_data(noise=1e-6), motor)
    tiny = tuple(replace(f, mean_square=1e-12) for f in search.plain.fits)
    assert not only_noise(search.problem, replace(search.plain, fits=tiny), SETTINGS)
