"""A motor that turns a load through an elastic gear, measured at the motor alone, and driven slowly at first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.random import Generator

from experiments.concealed.workshop import laws
from experiments.concealed.workshop.plant import Channel, Concealed, Drive, Entry, Port, State
from experiments.concealed.workshop.signals import shaking
from experiments.resolving.machines.base import Limited

MOTOR = Port(lambda s, p: 0.0, lambda s, p: s[0])
LOAD = Port(lambda s, p: 0.0, lambda s, p: s[2])


def _dry(port: str) -> Entry:
    return Entry(
        lambda g, c: Concealed([(port, laws.coulomb(g.uniform(0.03, 0.06)))]),
        ((port, "coulomb_friction"), (port, "stribeck_friction")),
    )


class GearedDrive(Limited):
    name, model = "drive", "GearedDrive"
    sample_time, samples, substeps = 0.005, 800, 10
    states = ("motor_speed", "twist", "load_speed")
    inputs = (Channel("torque", "torque", "N m"),)
    outputs = (Channel("motor_speed", "speed", "rad/s"),)
    truth = {"Jm": 0.01, "Jl": 0.02, "k": 20.0, "d": 0.05, "b": 0.04}
    known = ("k", "d")
    ports = {"motor": MOTOR, "load": LOAD}
    limits = {"torque": (-0.6, 0.6), "motor_speed": (-12.0, 12.0)}
    catalogue = {"motor_coulomb": _dry("motor"), "load_coulomb": _dry("load")}

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        gear = p["k"] * s[1] + p["d"] * (s[0] - s[2])
        return [
            (u[0] - p["b"] * s[0] - gear + f["motor"]) / p["Jm"],
            s[0] - s[2],
            (gear + f["load"]) / p["Jl"],
        ]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        torque = 0.12 * shaking(rng, self.samples, self.sample_time, 0.25, 1.5)
        return Drive(torque[:, None], 0.0 * torque[:, None])
