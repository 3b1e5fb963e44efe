"""A voice coil on a flexure: current [A], position [µm in the file, m in the model], 2 kHz."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import shaking, steps, sweep

COIL = Port(lambda s, p: s[1], lambda s, p: s[2])
FLEXURE = Port(lambda s, p: s[1], lambda s, p: s[2], sign=1.0)
MOVER = entries.Place("coil", COIL, (0.03, 0.12))
LEAF = entries.Place("flexure", FLEXURE, (0.05, 0.2))


class VoiceCoil(Machine):
    name, model = "voice_coil", "VoiceCoil"
    sample_time, samples, substeps = 0.0005, 1600, 10
    states = ("current", "position", "speed")
    inputs = (Channel("voltage", "u", "V"),)
    outputs = (Channel("current", "i", "A"), Channel("position", "x_um", "m", scale=1e-6))
    truth = {"L": 1.5e-3, "R": 2.4, "K": 6.0, "m": 0.08, "k": 900.0, "d": 1.2}
    known = ("m",)
    ports = {"coil": COIL, "flexure": FLEXURE}
    catalogue = {
        **entries.dry(MOVER),
        **entries.stops(MOVER),
        **entries.one(
            LEAF, "cubic", lambda g, c: laws.cubic(g.uniform(0.1, 0.4) * c.truth["k"] / (2.0 * c.usual(COIL.position)) ** 2),
            ("nonlinear_stiffness",), ("unknown",),
        ),
        **entries.one(
            LEAF, "bouc_wen", lambda g, c: laws.bouc_wen(g.uniform(0.04, 0.15), c.usual(COIL.position) * g.uniform(0.1, 0.4)),
            ("hysteretic_spring",), ("nonlinear_stiffness", "unknown"), also=(("coil", "presliding_hysteresis"),),
        ),
        **entries.actuator("actuator", "voltage", index=0, timing=(0.0003, 0.002), gain=False, level=False),
        **entries.sensor("sensor.position", "position", timing=(0.0005, 0.003)),
        "current_low": entries.Entry(
            lambda g, c: entries.Concealed(sensors={"current": {"gain": 1.0 - g.uniform(0.08, 0.2)}}),
            # force and back-EMF have one constant: any gain on the way tells the same
            (("sensor.current", "sensor_gain"), ("sensor.position", "sensor_gain"), ("actuator", "input_gain")),
            family="sensor current",
        ),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        i, x, v = s
        return [
            (u[0] - p["R"] * i - p["K"] * v) / p["L"],
            v,
            (p["K"] * i - p["k"] * x - f["flexure"] - p["d"] * v + f["coil"]) / p["m"],
        ]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], s[1]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        kinds = (
            lambda: 1.2 * shaking(rng, n, self.sample_time, 2.0, 200.0),
            lambda: steps(rng, n, -2.0, 2.0),
            lambda: 1.5 * sweep(rng, n) + 0.5 * shaking(rng, n, self.sample_time, 2.0, 100.0),
        )
        return Drive(kinds[number]()[:, None], np.zeros((n, 0)))
