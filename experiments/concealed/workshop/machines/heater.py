"""An extruder's barrel with two heated zones: temperatures [degC], half a second a sample, two heaters switched in long steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import steps

ROOM = 22.0
FRONT = Port(lambda s, p: s[0], lambda s, p: 0.0)
BACK = Port(lambda s, p: s[1], lambda s, p: 0.0)
FIRST = entries.Place("front_zone", FRONT, (1.0, 2.0))
SECOND = entries.Place("back_zone", BACK, (1.0, 2.0))


class Heater(Machine):
    name, model = "heater", "Barrel"
    sample_time, samples, substeps = 0.5, 1600, 6
    states = ("front", "back")
    inputs = (Channel("heat1", "kw1", "W", scale=1e3), Channel("heat2", "kw2", "W", scale=1e3))
    outputs = (Channel("front", "T1", "degC"), Channel("back", "T2", "degC"))
    truth = {"C1": 900.0, "C2": 1200.0, "h12": 9.0, "h2": 7.0}
    ports = {"front_zone": FRONT, "back_zone": BACK}
    catalogue = {
        **entries.one(
            FIRST, "leak", lambda g, c: laws.leak(g.uniform(0.8, 4.0), ROOM), ("linear_leak",), ("unknown", "threshold_flow")
        ),
        **entries.one(
            FIRST, "radiation", lambda g, c: laws.radiation(g.uniform(5e-9, 2e-8), ROOM), ("unknown",),
            ("linear_leak", "threshold_flow"), outside=True,
        ),
        **entries.one(
            SECOND, "cooling", lambda g, c: laws.bias(-g.uniform(40.0, 150.0)), ("constant_bias",), ("linear_leak",)
        ),
        **entries.one(
            SECOND, "thermostat",
            lambda g, c: laws.overflow(g.uniform(10.0, 40.0), float(np.mean(c.reach(BACK.position))) * g.uniform(0.95, 1.3)),
            ("threshold_flow",), ("unknown",),
        ),
        **entries.actuator("actuator.heat1", "heat1", index=0, timing=(2.0, 15.0), dead=False, level=False),
        **entries.actuator("actuator.heat2", "heat2", index=1, timing=(2.0, 15.0), limit=False, dead=False, gain=True, level=False),
        **entries.sensor("sensor.back", "back", timing=(2.0, 12.0)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        through = p["h12"] * (s[0] - s[1])
        return [
            (u[0] - through + f["front_zone"]) / p["C1"],
            (u[1] + through - p["h2"] * (s[1] - ROOM) + f["back_zone"]) / p["C2"],
        ]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], s[1]]

    def start(self, rng: Generator, p: Mapping[str, float]) -> list[float]:
        return [ROOM, ROOM] if rng.random() < 0.5 else [rng.uniform(60, 120), rng.uniform(50, 100)]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        both = np.stack([steps(rng, n, 0.0, 1200.0), steps(rng, n, 0.0, 800.0)], axis=1)
        return Drive(both, np.zeros((n, 0)))
