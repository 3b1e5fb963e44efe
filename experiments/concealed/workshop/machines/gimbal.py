"""A platform on a pivot with a reaction wheel: platform angle [deg], wheel speed [rpm in the file, rad/s in the model]."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi, radians

from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import shaking, steps, sweep

PIVOT = Port(lambda s, p: radians(s[0]), lambda s, p: radians(s[1]))
BEARING = Port(lambda s, p: 0.0, lambda s, p: s[2] - radians(s[1]))
WHEEL = entries.Place("bearing", BEARING, (0.0008, 0.003))
BASE = entries.Place("pivot", PIVOT, (0.001, 0.004))


class Gimbal(Machine):
    name, model = "gimbal", "Gimbal"
    sample_time, samples, substeps = 0.02, 1500, 12
    states = ("angle", "rate", "wheel")
    inputs = (Channel("torque", "mNm", "N m", scale=1e-3),)
    outputs = (Channel("angle", "deg", "deg"), Channel("wheel", "rpm", "rad/s", scale=2.0 * pi / 60.0))
    truth = {"J": 0.02, "Jw": 4e-4, "k": 0.06, "d": 0.004, "b": 2e-5}
    known = ("Jw",)
    ports = {"pivot": PIVOT, "bearing": BEARING}
    catalogue = {
        **entries.dry(BASE),
        **entries.stops(BASE),
        **entries.one(
            BASE, "imbalance", lambda g, c: laws.weight(g.uniform(0.004, 0.015), g.uniform(0.004, 0.015)), ("gravity",),
            ("constant_bias",),
        ),
        **entries.one(
            BASE, "cable", lambda g, c: laws.slack_spring(g.uniform(0.03, 0.1), 0.5 * c.usual(PIVOT.position)), ("unknown",),
            ("end_stop", "gravity"), outside=True,
        ),
        **entries.dry(WHEEL),
        **entries.actuator("actuator", "torque", index=0, timing=(0.01, 0.08), gain=True),
        **entries.sensor("sensor.angle", "angle", timing=(0.02, 0.1)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        turn = radians(s[1])
        drag = p["b"] * (s[2] - turn) - f["bearing"]
        back = -u[0] + drag
        return [
            s[1],
            (back - p["k"] * radians(s[0]) - p["d"] * turn + f["pivot"]) / p["J"] * 180.0 / pi,
            (u[0] - drag) / p["Jw"],
        ]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], s[2]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        shaken = 0.008 * shaking(rng, n, self.sample_time, 0.1, 3.0) if number != 1 else 0.01 * steps(rng, n, -1.0, 1.0)
        wheel = 80.0 * (sweep(rng, n) if number == 2 else steps(rng, n, -1.0, 1.0, corner=20.0))
        return Drive(shaken[:, None], (wheel - wheel[0])[:, None], (1,), (2e-4,), (0.0,))
