"""A lag that is shorter than a sample has its mean delay and nothing else."""

from __future__ import annotations

import pytest
import torch

from greybox_torch.mechanisms.short_lag import SHORTEST, lag_change, lag_rate

STEP = 0.01


def followed(share: float) -> tuple[float, float]:
    """How far behind a ramp of slope 1 a lag of ``share`` samples ends, in samples, and what it changes of a step at once."""
    time_constant = torch.tensor(share * STEP, dtype=torch.float64)
    lagged = torch.zeros((), dtype=torch.float64)
    for k in range(200):  # Runge-Kutta steps of one sample

        def rate(value: torch.Tensor, at: float) -> torch.Tensor:
            return lag_rate(torch.tensor(at, dtype=torch.float64), value, time_constant, STEP)

        t = k * STEP
        a = rate(lagged, t)
        b = rate(lagged + 0.5 * STEP * a, t + 0.5 * STEP)
        c = rate(lagged + 0.5 * STEP * b, t + 0.5 * STEP)
        d = rate(lagged + STEP * c, t + STEP)
        lagged = lagged + STEP / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    behind = -lag_change(torch.tensor(200 * STEP, dtype=torch.float64), lagged, time_constant, STEP)
    at_once = lag_change(torch.tensor(1.0), torch.tensor(0.0), time_constant, STEP)
    return float(behind) / STEP, float(at_once)


@pytest.mark.parametrize("share", [0.0, 0.05, 0.2, 0.45, 1.0, 3.0])
def test_a_lag_of_any_length_is_followed_and_late_by_its_time_constant(share: float) -> None:
    assert followed(share)[0] == pytest.approx(share, rel=1e-6, abs=1e-12)


def test_it_is_absent_at_zero_and_whole_from_where_it_can_be_followed() -> None:
    assert followed(0.0)[1] == 0.0
    assert followed(SHORTEST)[1] == pytest.approx(-1.0) and followed(2.0)[1] == pytest.approx(-1.0)
    assert followed(0.5 * SHORTEST)[1] == pytest.approx(-0.5)
