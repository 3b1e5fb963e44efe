"""Small things that every recording has and no model holds: torque noise, slow drift, samples a little off their time.

All far below the effects: they belong to the floor that even the true model leaves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from experiments.concealed.laws import Law
from experiments.concealed.laws.nuisance import Disturbance, Jitter

Array = NDArray[np.float64]
JITTER = 0.01  # of the sample time, RMS


@dataclass(frozen=True)
class Nuisances:
    """disturbance (total, 4) of the force [N m or N], jitter (outputs, total, 4) [s]."""

    disturbance: Array
    jitter: Array

    def times(self, factor: float) -> Nuisances:
        """All of them, larger or smaller."""
        return Nuisances(factor * self.disturbance, factor * self.jitter)


def draw_nuisances(
    rng: Generator, outputs: int, total: int, sample_time: float, *, noise: float, drift: float
) -> Nuisances:
    """White torque noise of RMS `noise`, and a slow sine of amplitude `drift` and 5 to 20 s, each experiment its own."""
    time = np.arange(total)[:, None] * sample_time
    period, phase = rng.uniform(5.0, 20.0, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
    slow = drift * np.sin(2.0 * np.pi * time / period + phase)
    jitter = JITTER * sample_time * rng.standard_normal((outputs, total, 4))
    return Nuisances(slow + noise * rng.standard_normal((total, 4)), jitter)


def nuisance_laws(drawn: list[Nuisances], body: str, sensors: tuple[str, ...], start_time: float) -> list[Law]:
    """The laws of all trials' nuisances, on lanes 4 i + j of trial i."""
    lanes = np.arange(4 * len(drawn))
    laws: list[Law] = [Disturbance(lanes, np.concatenate([n.disturbance for n in drawn], axis=1), body, start_time)]
    for k, sensor in enumerate(sensors):
        laws.append(Jitter(lanes, np.concatenate([n.jitter[k] for n in drawn], axis=1), sensor))
    return laws
