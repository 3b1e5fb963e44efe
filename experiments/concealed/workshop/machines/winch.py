"""A winch, its rope and a hanging load: drum angle [counts], force in the rope [N]."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import path, shaking, sweep

RADIUS, MASS, G = 0.1, 80.0, 9.81
DRUM = Port(lambda s, p: s[0], lambda s, p: s[2])
LOAD = Port(lambda s, p: s[1], lambda s, p: s[3])
ROPE = Port(lambda s, p: RADIUS * s[0] - s[1], lambda s, p: RADIUS * s[2] - s[3], sign=1.0)
BEARING = entries.Place("drum", DRUM, (3.0, 12.0), drive="actuator")
GUIDE = entries.Place("load", LOAD, (30.0, 120.0))
STRAND = entries.Place("rope", ROPE, (50.0, 150.0))


class Winch(Machine):
    name, model = "winch", "Winch"
    sample_time, samples, substeps = 0.005, 1200, 10
    states = ("angle", "height", "drum_speed", "load_speed")
    inputs = (Channel("torque", "torque", "N m"),)
    outputs = (
        Channel("angle", "ticks", "rad", scale=2.0 * np.pi / 8192, counts=True),
        Channel("force", "rope_force", "N"),
    )
    truth = {"J": 1.5, "k": 3e4, "d": 150.0, "b": 4.0, "c": 10.0}
    ports = {"drum": DRUM, "load": LOAD, "rope": ROPE}
    catalogue = {
        **entries.dry(BEARING),
        **entries.dry(GUIDE),
        **entries.one(
            STRAND, "bouc_wen", lambda g, c: laws.bouc_wen(g.uniform(50, 150), g.uniform(1e-3, 4e-3)), ("hysteretic_spring",),
            ("nonlinear_stiffness", "nonlinear_damping", "unknown"),
        ),
        **entries.one(
            STRAND, "one_way", lambda g, c: laws.one_way_damper(g.uniform(200, 800)), ("nonlinear_damping",), ("unknown",)
        ),
        **entries.drag(GUIDE, force=(30.0, 120.0)),
        **entries.actuator("actuator", "torque", index=0, timing=(0.001, 0.02), body="drum", gain=True, dead=False),
        **entries.sensor("sensor.force", "force", timing=(0.008, 0.03)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        pull = p["k"] * (RADIUS * s[0] - s[1]) + p["d"] * (RADIUS * s[2] - s[3]) + f["rope"]
        return [
            s[2],
            s[3],
            (u[0] - p["b"] * s[2] - RADIUS * pull + f["drum"]) / p["J"],
            (pull - MASS * G - p["c"] * s[3] + f["load"]) / MASS,
        ]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], p["k"] * (RADIUS * s[0] - s[1]) + p["d"] * (RADIUS * s[2] - s[3])]

    def start(self, rng: Generator, p: Mapping[str, float]) -> list[float]:
        return [0.0, -MASS * G / p["k"], 0.0, 0.0]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        shaken = MASS * G * RADIUS + 12.0 * shaking(rng, n, self.sample_time, 0.3, 12.0)
        way = 12.0 * (path(rng, n, 40.0) if number < 2 else sweep(rng, n))
        return Drive(shaken[:, None], (way - way[0])[:, None], (0,), (40.0,), (12.0,))
