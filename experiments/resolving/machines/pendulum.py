"""A pendulum that its first recordings hardly swing: what is small is linear, and a place in the chain cannot be told."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sin

from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Concealed, Drive, Entry, Port, State
from experiments.concealed.workshop.signals import shaking
from experiments.resolving.machines.base import Limited

PIVOT = Port(lambda s, p: s[0], lambda s, p: s[1])
CONSTANT = (("pivot", "constant_bias"), ("actuator", "input_bias"))
OFFSET = (("sensor", "sensor_bias"),)


class Pendulum(Limited):
    name, model = "pendulum", "Pendulum"
    sample_time, samples, substeps = 0.01, 700, 8
    states = ("angle", "speed")
    inputs = (Channel("torque", "torque", "N m"),)
    outputs = (Channel("angle", "angle", "rad"),)
    truth = {"J": 0.02, "c": 0.05, "w": 0.5}
    ports = {"pivot": PIVOT}
    limits = {"torque": (-0.6, 0.6), "angle": (-2.5, 2.5)}
    catalogue = {
        **entries.actuator("actuator", "torque", index=0, timing=(0.02, 0.05)),
        **entries.sensor("sensor", "angle", timing=(0.02, 0.05)),
        "offset": Entry(lambda g, c: Concealed(sensors={"angle": {"bias": g.uniform(0.03, 0.08)}}), OFFSET),
        "bias": Entry(lambda g, c: Concealed([("pivot", laws.bias(g.uniform(0.015, 0.04)))]), CONSTANT),
        "imbalance": Entry(
            lambda g, c: Concealed([("pivot", laws.weight(0.0, g.uniform(0.015, 0.04)))]), (("pivot", "gravity"),)
        ),
    }

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        return [s[1], (u[0] - p["c"] * s[1] - p["w"] * sin(s[0]) + f["pivot"]) / p["J"]]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        torque = 0.06 * shaking(rng, self.samples, self.sample_time, 0.3, 2.0)
        return Drive(torque[:, None], 0.0 * torque[:, None])
