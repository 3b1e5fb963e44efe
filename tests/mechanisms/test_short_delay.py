"""A dead time of the output that is hardly longer than a sample is late by as much, one step of the integrator per sample."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.sensor import OutputDelay
from greybox_torch.model import Signals

STEP, PERIOD = 0.01, 30
"""Sample time in s, and samples of a period of the output."""


def recorded(share: float) -> tuple[np.ndarray, np.ndarray]:
    """Samples 200 to 500 of a sine and of what is recorded of it, ``share`` samples late, by Runge-Kutta steps of one sample."""
    law, p = OutputDelay(), Signals("parameters", {"T": torch.tensor(share * STEP, dtype=torch.float64)})
    omega = 2 * np.pi / (PERIOD * STEP)

    def seen(t: float) -> Signals:
        output = torch.tensor(np.sin(omega * t), dtype=torch.float64)
        return Signals("local", {"output": output, "sample_time": torch.tensor(STEP, dtype=torch.float64)})

    def rate(z: torch.Tensor, t: float) -> torch.Tensor:
        rates = law.rates(seen(t), p, Signals("memory", {"filtered": z[0], "slope": z[1]}))
        return torch.stack([rates["filtered"], rates["slope"]])

    z, late = torch.zeros(2, dtype=torch.float64), []
    for k in range(500):
        t = k * STEP
        signals = seen(t)
        late.append(float(signals.output + law.force(signals, p, Signals("memory", {"filtered": z[0], "slope": z[1]}))))
        a = rate(z, t)
        b = rate(z + 0.5 * STEP * a, t + 0.5 * STEP)
        c = rate(z + 0.5 * STEP * b, t + 0.5 * STEP)
        z = z + STEP / 6.0 * (a + 2.0 * b + 2.0 * c + rate(z + STEP * c, t + STEP))
    return omega * STEP * np.arange(200, 500), np.array(late[200:])


@pytest.mark.parametrize("share", [0.5, 1.0, 1.36, 2.0, 5.0])
def test_a_short_dead_time_is_late_by_its_time_and_damps_next_to_nothing(share: float) -> None:
    phase, late = recorded(share)
    sine, cosine = np.linalg.lstsq(np.stack([np.sin(phase), np.cos(phase)], axis=1), late)[0]
    assert -np.arctan2(cosine, sine) * PERIOD / (2 * np.pi) == pytest.approx(share, rel=0.02)
    assert np.hypot(sine, cosine) == pytest.approx(1.0, abs=0.02)


def test_a_time_of_less_than_two_samples_may_be_estimated(around) -> None:
    (time,) = OutputDelay().parameters(around)
    assert time.bounds[0] <= 0.5 * around.sample_time
