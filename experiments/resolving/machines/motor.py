"""A DC motor that its first recordings turn in one direction only, and slowly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Concealed, Drive, Entry, Port, Seen, State
from experiments.concealed.workshop.signals import steps
from experiments.resolving.machines.base import Limited

ROTOR = Port(lambda s, p: 0.0, lambda s, p: s[0])
# The machine is linear and its drag known as far as the recordings go: an offset of its only sensor is a constant force.
BIAS = (("rotor", "constant_bias"), ("actuator", "input_bias"), ("sensor", "sensor_bias"))
DRY = (("rotor", "coulomb_friction"), ("rotor", "stribeck_friction"))


def _uneven(g: Generator, c: Seen) -> Concealed:
    level = g.uniform(0.02, 0.05)
    return Concealed([("rotor", laws.uneven(level, level * g.uniform(0.4, 0.8)))])


class Motor(Limited):
    name, model = "motor", "Motor"
    sample_time, samples, substeps = 0.01, 500, 20
    states = ("speed",)
    inputs = (Channel("voltage", "voltage", "V"),)
    outputs = (Channel("speed", "speed", "rad/s"),)
    truth = {"J": 0.02, "k": 0.1, "b": 0.05}
    known = ("k",)
    ports = {"rotor": ROTOR}
    limits = {"voltage": (-4.0, 4.0), "speed": (-10.0, 10.0)}
    catalogue = {
        "bias": Entry(lambda g, c: Concealed([("rotor", laws.bias(-g.uniform(0.02, 0.05)))]), BIAS),
        "coulomb": Entry(lambda g, c: Concealed([("rotor", laws.coulomb(g.uniform(0.02, 0.05)))]), DRY),
        # Levels that differ, where it truly sticks, are a constant force beside their mean.
        "uneven": Entry(_uneven, (*DRY, ("rotor", "coulomb_asymmetry"))),
        **entries.actuator("actuator", "voltage", index=0, timing=(0.02, 0.05)),
    }

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        return [(p["k"] * u[0] - p["b"] * s[0] + f["rotor"]) / p["J"]]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0]]

    def start(self, rng: Generator, p: Mapping[str, float]) -> list[float]:
        return [float(rng.uniform(2.5, 4.0))]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        voltage = steps(rng, self.samples, 1.5, 3.5, corner=4.0)
        return Drive(voltage[:, None], 0.0 * voltage[:, None])
