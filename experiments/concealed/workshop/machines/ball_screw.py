"""A servo motor, a belt, a ball screw and its table: encoder on the motor [counts], scale on the table [µm in the file, m in the model]."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import path, shaking, sweep

LEAD = 0.01 / (2.0 * np.pi)
"""Of the screw [m/rad]."""
MOTOR = Port(lambda s, p: s[0], lambda s, p: s[2])
TABLE = Port(lambda s, p: s[1], lambda s, p: s[3])
BELT = Port(lambda s, p: LEAD * s[0] - s[1], lambda s, p: LEAD * s[2] - s[3], sign=1.0)
ROTOR = entries.Place("rotor", MOTOR, (0.02, 0.08), drive="actuator")
SLIDE = entries.Place("slide", TABLE, (15.0, 60.0))
BELTED = entries.Place("belt", BELT, (20.0, 80.0))


class BallScrew(Machine):
    name, model = "ball_screw", "BallScrew"
    sample_time, samples, substeps = 0.001, 1500, 10
    states = ("angle", "position", "motor_speed", "table_speed")
    inputs = (Channel("torque", "i_q", "N m", scale=0.35),)
    outputs = (
        Channel("angle", "encoder", "rad", scale=2.0 * np.pi / 4096, counts=True),
        Channel("position", "scale_um", "m", scale=1e-6),
    )
    truth = {"J": 4e-4, "m": 24.0, "k": 6e5, "d": 600.0, "b": 2e-3, "c": 60.0}
    known = ("m",)
    ports = {"rotor": MOTOR, "slide": TABLE, "belt": BELT}
    catalogue = {
        **entries.dry(ROTOR),
        **entries.dry(SLIDE),
        **entries.stops(SLIDE),
        **entries.one(
            ROTOR, "cogging", lambda g, c: laws.ripple(g.uniform(0.02, 0.06), 10.0, g.uniform(0, 6.28)), ("torque_ripple",)
        ),
        **entries.one(
            BELTED, "backlash", lambda g, c: laws.dead_band(c.truth["k"], g.uniform(5e-6, 3e-5)), ("backlash",),
            ("nonlinear_stiffness", "hysteretic_spring"),
        ),
        **entries.one(
            BELTED, "bouc_wen", lambda g, c: laws.bouc_wen(g.uniform(30, 90), g.uniform(5e-6, 2e-5)), ("hysteretic_spring",),
            ("backlash", "nonlinear_stiffness", "nonlinear_damping", "unknown"),
        ),
        **entries.actuator("actuator", "torque", index=0, timing=(0.0002, 0.003), body="rotor", gain=True),
        **entries.sensor("sensor.position", "position", timing=(0.001, 0.004)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        pull = p["k"] * (LEAD * s[0] - s[1]) + p["d"] * (LEAD * s[2] - s[3]) + f["belt"]
        return [
            s[2],
            s[3],
            (u[0] - p["b"] * s[2] - LEAD * pull + f["rotor"]) / p["J"],
            (pull - p["c"] * s[3] + f["slide"]) / p["m"],
        ]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], s[1]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        shaken = 0.15 * shaking(rng, n, self.sample_time, 2.0, 60.0)
        way = 25.0 * (path(rng, n, 30.0) if number < 2 else sweep(rng, n))
        return Drive(shaken[:, None], (way - way[0])[:, None], (0,), (0.08,), (0.006,))
