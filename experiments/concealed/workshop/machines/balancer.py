"""A boom that stands upright on its motor, held there by feedback: no free run from a measured start can follow it for long."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sin

from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import path, shaking, sweep

JOINT = Port(lambda s, p: s[0], lambda s, p: s[1])
HINGE = entries.Place("joint", JOINT, (1.0, 4.0), drive="actuator")


class Balancer(Machine):
    name, model = "balancer", "Balancer"
    unstable = True
    sample_time, samples, substeps = 0.005, 1200, 10
    states = ("tilt", "rate")
    inputs = (Channel("torque", "motor", "N m"),)
    outputs = (Channel("tilt", "tilt", "rad"),)
    truth = {"J": 1.2, "mgl": 35.0, "b": 0.8}
    known = ("mgl",)
    ports = {"joint": JOINT}
    catalogue = {
        **entries.dry(HINGE),
        **entries.stops(HINGE),
        **entries.one(
            HINGE, "cable", lambda g, c: laws.slack_spring(g.uniform(8, 25), 0.5 * c.usual(JOINT.position)), ("unknown",),
            ("end_stop", "gravity"), outside=True,
        ),
        **entries.actuator("actuator", "torque", index=0, timing=(0.002, 0.02), body="joint", gain=True),
        **entries.sensor("sensor", "tilt", timing=(0.005, 0.02)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        return [s[1], (p["mgl"] * sin(s[0]) - p["b"] * s[1] + u[0] + f["joint"]) / p["J"]]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        shaken = 3.0 * shaking(rng, n, self.sample_time, 0.3, 10.0)
        way = 0.4 * (path(rng, n, 30.0) if number < 2 else sweep(rng, n))
        return Drive(shaken[:, None], (way - way[0])[:, None], (0,), (110.0,), (14.0,))
