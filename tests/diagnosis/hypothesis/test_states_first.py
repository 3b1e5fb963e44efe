"""Long windows that begin from what shorter ones found."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import pytest

from greybox_torch.diagnosis.hypothesis.fit import _states_first, window_lengths
from greybox_torch.diagnosis.hypothesis.noise import reaches_noise
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()


def test_long_windows_that_lost_the_way_begin_from_what_shorter_ones_found(motor_data, motor, begun) -> None:
    """Seen: a transmission error found at the noise over 1240 samples, lost over 4960, and so taken back on other experiments."""
    search = begun(motor_data(noise=0.1), motor)
    *shorter, longest = search.plain.fits
    assert all(reaches_noise(search.problem, fit, SETTINGS) for fit in search.plain.fits)
    lost = replace(
        longest, mean_square=9 * longest.mean_square, problem=longest.problem.with_values(3 * longest.problem.values)
    )
    assert not reaches_noise(search.problem, lost, SETTINGS)
    again = partial(
        _states_first, fits=shorter, simulator=search.plain.simulator, length=window_lengths(search.problem)[-1]
    )
    found = again(lost, limits=BUDGET.window_iterations, budget=BUDGET)
    assert found.windows.steps == longest.windows.steps and reaches_noise(search.problem, found, SETTINGS)
    assert found.mean_square == pytest.approx(longest.mean_square, rel=1e-2)
    assert again(longest, limits=BUDGET.window_iterations, budget=BUDGET).mean_square <= longest.mean_square
