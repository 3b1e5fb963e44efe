from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.model import Signals

SPANS = {
    "speed": (-20.0, 16.0),
    "position": (-3.0, 5.0),
    "load": (-8.0, 7.0),
    "time": (0.0, 10.0),
    "deflection": (-0.06, 0.05),
    "rate": (-2.0, 2.5),
    "level": (0.5, 4.0),
    "input": (-6.0, 5.0),
    "delayed": (-6.0, 5.0),
    "output": (-20.0, 16.0),
}

UNITS = {
    "speed": "rad/s",
    "position": "rad",
    "load": "N m",
    "time": "s",
    "deflection": "rad",
    "rate": "rad/s",
    "level": "m",
    "input": "V",
    "output": "rad/s",
}


@pytest.fixture(scope="session")
def around() -> Surroundings:
    """A place where every signal moved over an interval that is not symmetric."""
    ranges = {name: Range(low, high, 0.4 * (high - low)) for name, (low, high) in SPANS.items()}
    return Surroundings(ranges, UNITS, "N m", 1e-3)


@pytest.fixture(scope="session")
def anywhere() -> dict[str, np.ndarray]:
    """500 points drawn over the whole of those intervals, by signal."""
    rng = np.random.default_rng(1)
    return {name: rng.uniform(low, high, 500) for name, (low, high) in SPANS.items()}


class Law(Protocol):
    def __call__(
        self, mechanism: Mechanism, values: Mapping[str, float], memory: Mapping[str, Any] = ..., **signals: Any
    ) -> np.ndarray: ...


def named(kind: str, values: Mapping[str, Any]) -> Signals:
    return Signals(kind, {n: torch.as_tensor(np.asarray(v, dtype=float)) for n, v in values.items()})


@pytest.fixture(scope="session")
def law(around: Surroundings) -> Law:
    """The force of a law (the deflection that the spring sees, for a kinematic one); parameters not given are at their start."""

    def evaluate(mechanism, values, memory=None, **signals):
        start = {p.name: p.value for p in mechanism.parameters(around)}
        assert set(values) <= set(start), "the test gives a parameter that the law does not have"
        s, p, z = (
            named("signal", {"sample_time": 1e-4, **signals}),
            named("parameter", {**start, **values}),
            named("memory", memory or {}),
        )
        value = mechanism.deflection(s, p) if mechanism.kinematic else mechanism.force(s, p, z)
        shape = np.broadcast_shapes(*(np.shape(v) for v in (*signals.values(), *(memory or {}).values())))
        return np.broadcast_to(np.asarray(value), shape)

    return evaluate


@pytest.fixture(scope="session")
def rates(around: Surroundings) -> Law:
    """The rate of a law's memory, stacked (states, ...)."""

    def evaluate(mechanism, values, memory=None, **signals):
        start = {p.name: p.value for p in mechanism.parameters(around)}
        s, p, z = (
            named("signal", {"sample_time": 1e-4, **signals}),
            named("parameter", {**start, **values}),
            named("memory", memory or {}),
        )
        found = mechanism.rates(s, p, z)
        assert set(found) == {state.name for state in mechanism.states(around)}
        return np.array(np.broadcast_arrays(*(np.asarray(v) for v in found.values())))

    return evaluate
