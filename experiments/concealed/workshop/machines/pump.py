"""A pump and two tanks in cascade: levels [mm in the file, m in the model], one sample a second."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt

import numpy as np
from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import steps

AREA = 0.05
UPPER = Port(lambda s, p: s[0], lambda s, p: 0.0)
LOWER = Port(lambda s, p: s[1], lambda s, p: 0.0)
HIGH = entries.Place("upper_tank", UPPER, (1.0, 2.0))
LOW = entries.Place("lower_tank", LOWER, (1.0, 2.0))


class Pump(Machine):
    name, model = "pump", "Cascade"
    sample_time, samples, substeps = 1.0, 1200, 10
    states = ("upper", "lower")
    inputs = (Channel("drive", "percent", "1", scale=0.01),)
    outputs = (Channel("upper", "h1_mm", "m", scale=1e-3), Channel("lower", "h2_mm", "m", scale=1e-3))
    truth = {"q": 1.2e-3, "a1": 9e-4, "a2": 1.0e-3}
    ports = {"upper_tank": UPPER, "lower_tank": LOWER}
    catalogue = {
        **entries.one(
            HIGH, "leak", lambda g, c: laws.leak(g.uniform(1e-4, 5e-4), 0.0), ("linear_leak",), ("unknown", "threshold_flow")
        ),
        **entries.one(
            LOW, "leak", lambda g, c: laws.leak(g.uniform(1e-4, 5e-4), 0.0), ("linear_leak",), ("unknown", "threshold_flow")
        ),
        **entries.one(
            HIGH, "overflow",
            lambda g, c: laws.overflow(g.uniform(2e-3, 1e-2), c.reach(UPPER.position)[1] * g.uniform(0.5, 0.75)),
            ("threshold_flow",), ("unknown",),
        ),
        **entries.one(
            LOW, "overflow",
            lambda g, c: laws.overflow(g.uniform(2e-3, 1e-2), c.reach(LOWER.position)[1] * g.uniform(0.5, 0.75)),
            ("threshold_flow",), ("unknown",),
        ),
        **entries.one(
            LOW, "inflow", lambda g, c: laws.bias(g.uniform(3e-5, 1.2e-4)), ("constant_bias",), ("linear_leak", "unknown")
        ),
        **entries.actuator(
            "actuator", "drive", index=0, timing=(2.0, 10.0), level=False,
        ),
        **entries.sensor("sensor.lower", "lower", timing=(3.0, 15.0)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        down = p["a1"] * sqrt(max(s[0], 1e-4))
        away = p["a2"] * sqrt(max(s[1], 1e-4))
        return [(p["q"] * u[0] - down + f["upper_tank"]) / AREA, (down - away + f["lower_tank"]) / AREA]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], s[1]]

    def start(self, rng: Generator, p: Mapping[str, float]) -> list[float]:
        return [rng.uniform(0.15, 0.4), rng.uniform(0.15, 0.4)]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        corner = 0.0 if number < 2 else 15.0
        return Drive(steps(rng, self.samples, 0.2, 0.75, corner=corner)[:, None], np.zeros((self.samples, 0)))
