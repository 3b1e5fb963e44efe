"""A hydraulic cylinder and its valve: load pressure [bar], position [mm]; no speed is measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.random import Generator

from experiments.concealed.workshop import entries, laws
from experiments.concealed.workshop.plant import Channel, Drive, Machine, Port, State
from experiments.concealed.workshop.signals import path, shaking, sweep

AREA = 1.2e-3
OIL = Port(lambda s, p: s[0], lambda s, p: 0.0)
ROD = Port(lambda s, p: 1e-3 * s[1], lambda s, p: s[2])
CHAMBER = entries.Place("oil", OIL, (1.0, 2.0))
PISTON = entries.Place("piston", ROD, (150.0, 700.0))


class Cylinder(Machine):
    name, model = "cylinder", "Cylinder"
    sample_time, samples, substeps = 0.002, 1500, 10
    states = ("pressure", "position", "speed")
    inputs = (Channel("valve", "u_valve", "V"),)
    outputs = (Channel("pressure", "p_load", "bar"), Channel("position", "x_mm", "mm"))
    truth = {"C": 0.05, "Kq": 9e-5, "Kc": 1.2e-6, "m": 150.0, "b": 1500.0}
    known = ("m",)
    ports = {"oil": OIL, "piston": ROD}
    catalogue = {
        **entries.dry(PISTON),
        **entries.stops(PISTON),
        **entries.one(
            CHAMBER, "leak", lambda g, c: laws.orifice(g.uniform(2e-6, 8e-6)), ("unknown",), ("linear_leak", "threshold_flow"),
            outside=True,
        ),
        **entries.one(PISTON, "load", lambda g, c: laws.bias(g.uniform(100.0, 500.0)), ("constant_bias", "gravity")),
        **entries.actuator("actuator", "valve", index=0, timing=(0.002, 0.012), level=False),
        **entries.sensor("sensor.pressure", "pressure", timing=(0.003, 0.012)),
    }  # fmt: skip

    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        flow = p["Kq"] * u[0] - p["Kc"] * s[0] - AREA * s[2] + f["oil"]
        return [
            flow / (1e-4 * p["C"]),
            1e3 * s[2],
            (AREA * 1e5 * s[0] - p["b"] * s[2] + f["piston"]) / p["m"],
        ]

    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        return [s[0], s[1]]

    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        n = self.samples
        shaken = 0.8 * shaking(rng, n, self.sample_time, 0.5, 20.0)
        way = 60.0 * (path(rng, n, 40.0) if number < 2 else sweep(rng, n))
        return Drive(shaken[:, None], (way - way[0])[:, None], (1,), (0.08,), (0.0,))
