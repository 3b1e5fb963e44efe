"""Recordings of which some show what others do not."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.data import DataSet

from ..conftest import STEP, turned

SLOW, FAST = 0.3, 3.0
"""Voltages at which a drag does not show, and does."""


@pytest.fixture(scope="session")
def drag_at_speed(data_set):
    """A motor with quadratic drag, first recorded so slowly that it does not show."""

    def make(levels=(SLOW, FAST, FAST), drag=0.01) -> DataSet:
        rng, experiments = np.random.default_rng(1), []
        for level in levels:
            voltage = np.repeat(rng.uniform(-level, level, 75), 20)
            speed = turned(voltage, lambda q, v: -drag * v * abs(v))
            experiments.append({"voltage": voltage, "speed": speed + rng.normal(0, 0.02, len(speed))})
        roles = ["estimation", *["validation"] * (len(levels) - 1)]
        return data_set({"voltage": "V", "speed": "rad/s"}, experiments, roles=roles, sample_time=STEP)

    return make
