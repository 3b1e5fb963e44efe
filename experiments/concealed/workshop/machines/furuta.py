"""A rotary pendulum that hangs (Furuta): both angles by encoders of 2048 counts, no speeds; the mass matrix depends on the pendulum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import cos, pi, sin

from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import path, shaking, sweep

ARM = Port(lambda s, p: s[0], lambda s, p: s[2])
ROD = Port(lambda s, p: s[1], lambda s, p: s[3])
HUB = entries.Place("arm", ARM, (0.004, 0.02), drive="actuator")
HINGE = entries.Place("pendulum", ROD, (0.0004, 0.002))
COUNT = 2.0 * pi / 2048


class Furuta(Machine):
    name, model = "furuta", "RotaryPendulum"
    sample_time, samples, substeps = 0.004, 1500, 10
    states = ("arm", "pendulum", "arm_speed", "pendulum_speed")
    inputs = (Channel("voltage", "V", "V"),)
    outputs = (
        Channel("arm", "arm_counts", "rad", scale=COUNT, counts=True),
        Channel("pendulum", "pend_counts", "rad", scale=COUNT, counts=True),
    )
    truth = {"Ja": 0.004, "Jp": 0.0012, "ml": 0.009, "mlr": 0.0016, "K": 0.04, "ba": 0.004, "bp": 1e-4}
    known = ("K",)
    ports = {"arm": ARM, "pendulum": ROD}
    catalogue = {
        **entries.dry(HUB),
        **entries.dry(HINGE),
        **entries.stops(HUB),
        **entries.one(
            HUB, "cable", lambda g, c: laws.slack_spring(g.uniform(0.02, 0.08), 0.5 * c.usual(ARM.position)), ("unknown",),
            ("end_stop", "gravity"), outside=True,
        ),
        **entries.one(
            HUB, "cogging", lambda g, c: laws.ripple(g.uniform(0.006, 0.02), 12.0, g.uniform(0, 6.28)), ("torque_ripple",)
        ),
        **entries.actuator("actuator", "voltage", index=0, timing=(0.003, 0.015), body="arm", gain=True),
        **entries.sensor("sensor.pendulum", "pendulum", timing=(0.004, 0.02)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        _, q, w, v = s
        mixed = p["mlr"] * cos(q)
        inertia = p["Ja"] + p["Jp"] * sin(q) ** 2
        swing = p["Jp"] * sin(2.0 * q)
        first = p["K"] * u[0] - p["ba"] * w - swing * w * v + p["mlr"] * sin(q) * v * v + f["arm"]
        second = 0.5 * swing * w * w - 9.81 * p["ml"] * sin(q) - p["bp"] * v + f["pendulum"]
        whole = inertia * p["Jp"] - mixed * mixed
        return [w, v, (p["Jp"] * first - mixed * second) / whole, (inertia * second - mixed * first) / whole]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], s[1]]

    def start(self, rng: Generator, p: Mapping[str, float]) -> list[float]:
        return [0.0, rng.uniform(-0.8, 0.8) if rng.random() < 0.5 else 0.0, 0.0, 0.0]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        shaken = 1.0 * shaking(rng, n, self.sample_time, 0.3, 6.0)
        way = 1.2 * (path(rng, n, 30.0) if number < 2 else sweep(rng, n))
        return Drive(shaken[:, None], (way - way[0])[:, None], (0,), (2.5,), (0.1,))
