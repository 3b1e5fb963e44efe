"""Recordings of a sled on a known path, whose missing forces are known to the last digit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
import pytest

from greybox_torch.data import DataSet, Role


class SledRun(Protocol):
    def __call__(
        self,
        missing: Callable[[np.ndarray, np.ndarray], np.ndarray] = ...,
        *,
        noise: float = ...,
        experiments: int = ...,
        travel: float = ...,
        roles: list[Role] | None = ...,
        samples: int = ...,
    ) -> DataSet: ...


@pytest.fixture(scope="session")
def sled_run(data_set) -> SledRun:
    """A sled of mass 2.5 and damping 0.8 moved along a known path of sines; the force that this takes is exact, nothing is simulated.

    ``missing`` of position and speed is a force on the sled that the model does not know; ``noise`` of the position sensor.
    """

    def make(missing=lambda q, v: 0.0 * q, *, noise=1e-5, experiments=2, travel=1.0, roles=None, samples=4000):
        step, n, rng, runs = 2e-3, samples, np.random.default_rng(0), []
        t = step * np.arange(n)
        for e in range(experiments):
            waves = [(0.30 * travel, 2.1 + 0.3 * e, 0.4), (0.12 * travel, 5.3, 1.0 + e), (0.02 * travel, 11.7, 0.2)]
            q = sum(a * np.sin(w * t + f) for a, w, f in waves)
            v = sum(a * w * np.cos(w * t + f) for a, w, f in waves)
            acceleration = sum(-a * w**2 * np.sin(w * t + f) for a, w, f in waves)
            force = 2.5 * acceleration + 0.8 * v - missing(q, v)
            runs.append({"F": force, "q": q + rng.normal(0, noise, n)})
        return data_set({"F": "N", "q": "m"}, runs, sample_time=step, hold="foh", roles=roles)

    return make
