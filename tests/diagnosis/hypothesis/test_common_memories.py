"""Experiments fitted together, of which a machine remembers another past at the beginning of each."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.unknown_fading import UnknownFading

from ..conftest import STEP

CHANGE, TIME, REACH, BEGINS = -0.6, 2.0, 3.0, (0.0, 0.5, 0.2)
FINE = 20


def turning(voltage: np.ndarray, used: float) -> np.ndarray:
    """The documentation's motor, whose gain fades as it warms; it begins as warm as ``used`` says; Euler steps, fine."""
    v, z, speeds, h = 0.0, used, [], STEP / FINE
    for u in voltage:
        speeds.append(v)
        for _ in range(FINE):
            v += h * (0.1 * u * (1.0 + CHANGE * z) - 0.05 * v) / 0.02
            z += h * ((u / REACH) ** 2 - z) / TIME
    return np.array(speeds)


def test_each_experiment_begins_as_its_past_has_left_it(data_set, motor, begun) -> None:
    """Seen: a winding that was half warm as one of two recordings began: with all of them rested 56 % was explained, and taken back."""
    rng, experiments = np.random.default_rng(3), []
    for used in BEGINS:
        voltage = np.repeat(rng.uniform(-REACH, REACH, 50), 20)
        voltage[0] = REACH
        experiments.append({"voltage": voltage, "speed": turning(voltage, used) + rng.normal(0, 0.01, 1000)})
    search = begun(data_set({"voltage": "V", "speed": "rad/s"}, experiments, sample_time=STEP), motor)
    fading = attach(motor, "actuator", UnknownFading("input"))
    start = search.plain.values() | {f"{fading.prefix}.change": -0.3, f"{fading.prefix}.T": 1.0}
    found = search.refitted((fading,), search.refitted((fading,), search.plain, [start]))
    assert found.values()[f"{fading.prefix}.T"] == pytest.approx(TIME, rel=0.1)
    used = [s.name for s in found.model.states].index(f"{fading.prefix}.used")
    np.testing.assert_allclose(found.problem.initial[:, used], BEGINS, atol=0.1)
    assert all(np.sqrt(fit.mean_square) < 1.2 * 0.01 for fit in found.fits), "what is left is noise"
