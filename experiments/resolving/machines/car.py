"""A quarter of a car on a shaker that moves the road, at first about one frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.random import Generator

from experiments.concealed.workshop import laws
from experiments.concealed.workshop.plant import Channel, Concealed, Drive, Entry, Port, Seen, State
from experiments.concealed.workshop.signals import shaking
from experiments.resolving.machines.base import Limited

SUSPENSION = Port(lambda s, p: s[0], lambda s, p: s[1] - s[3], sign=1.0)
SPRING = (("suspension", "nonlinear_stiffness"),)
DAMPER = (("suspension", "nonlinear_damping"),)


def _cubic(g: Generator, c: Seen) -> Concealed:
    reached = max(abs(x) for x in c.reach(SUSPENSION.position))
    return Concealed([("suspension", laws.cubic(g.uniform(0.3, 0.8) * c.truth["ks"] / reached**2))])


def _one_way(g: Generator, c: Seen) -> Concealed:
    return Concealed([("suspension", laws.one_way_damper(g.uniform(0.4, 0.9) * c.truth["cs"]))])


def _drag(g: Generator, c: Seen) -> Concealed:
    fastest = max(abs(x) for x in c.reach(SUSPENSION.rate))
    return Concealed([("suspension", laws.drag(g.uniform(0.5, 1.0) * c.truth["cs"] / fastest))])


class QuarterCar(Limited):
    name, model = "car", "QuarterCar"
    sample_time, samples, substeps = 0.01, 600, 10
    states = ("deflection", "body_speed", "tyre", "wheel_speed")
    inputs = (Channel("road_speed", "road", "m/s"),)
    outputs = (Channel("deflection", "deflection", "m"),)
    truth = {"ms": 300.0, "mu": 40.0, "ks": 16000.0, "cs": 1200.0, "kt": 160000.0}
    known = ("ms", "mu", "kt")
    ports = {"suspension": SUSPENSION}
    limits = {"road_speed": (-0.5, 0.5), "deflection": (-0.08, 0.08)}
    catalogue = {"cubic": Entry(_cubic, SPRING), "one_way": Entry(_one_way, DAMPER), "drag": Entry(_drag, DAMPER)}

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        force = p["ks"] * s[0] + p["cs"] * (s[1] - s[3]) + f["suspension"]
        return [s[1] - s[3], -force / p["ms"], s[3] - u[0], (force - p["kt"] * s[2]) / p["mu"]]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        middle = rng.uniform(0.9, 1.4)
        road = 0.08 * shaking(rng, self.samples, self.sample_time, 0.8 * middle, 1.2 * middle)
        return Drive(road[:, None], 0.0 * road[:, None])
