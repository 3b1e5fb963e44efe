"""Random small data sets for diagnoses: a machine, what its model leaves out, how it was driven, and what is wrong with the records.

The machines are integrated here, without the package.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from greybox_torch.data import DataSet, Recording, Role

Rate = Callable[[list[float], list[float], float], list[float]]


@dataclass(frozen=True)
class Machine:
    """A model of ``tests/machines/small.py`` as it is simulated here: (x, u, further force) -> dx/dt in true values.

    ``outputs`` are states by index; ``drive`` and ``reach`` are sizes of the first input and of the states; ``speed`` is the index of the
    state that friction opposes, ``step`` the sample time, ``free`` the true values of the parameters to be estimated.
    """

    name: str
    rate: Rate
    inputs: tuple[str, ...]
    outputs: tuple[tuple[str, int], ...]
    units: dict[str, str]
    drive: float
    reach: tuple[float, ...]
    speed: int
    step: float
    free: dict[str, float]


MACHINES = (
    Machine(
        "Rotor",
        lambda x, u, f: [(0.1 * u[0] - 0.05 * x[0] + f) / 0.02],
        ("voltage",),
        (("speed", 0),),
        {"voltage": "V", "speed": "rad/s"},
        3.0,
        (2.0,),
        0,
        0.01,
        {"J": 0.02, "b": 0.05},
    ),
    Machine(
        "Slide",
        lambda x, u, f: [x[1], u[0] - 25.0 * x[0] - 2.0 * x[1] + f],
        ("force",),
        (("position", 0),),
        {"force": "N", "position": "m"},
        3.0,
        (0.1, 0.3),
        1,
        0.02,
        {"k": 25.0, "d": 2.0},
    ),
    Machine(
        "Tank",
        lambda x, u, f: [(u[0] - 0.4 * x[0] + f) / 0.5],
        ("inflow",),
        (("level", 0),),
        {"inflow": "m^3/s", "level": "m"},
        1.0,
        (1.0,),
        0,
        0.1,
        {"c": 0.4},
    ),
    Machine(
        "Cart",
        lambda x, u, f: [x[1], (u[0] - 3.0 * x[1] - 2.0 * 9.81 * u[1] + f) / 2.0],
        ("force", "slope"),
        (("position", 0), ("speed", 1)),
        {"force": "N", "slope": "rad", "position": "m", "speed": "m/s"},
        5.0,
        (0.5, 0.5),
        1,
        0.02,
        {"m": 2.0, "d": 3.0},
    ),
    Machine(
        "WarmRotor",
        lambda x, u, f: [(0.1 * u[0] - 0.05 * x[0] + f) / 0.02, 0.01 * 0.05 * x[0] ** 2 - 0.2 * x[1]],
        ("voltage",),
        (("speed", 0),),
        {"voltage": "V", "speed": "rad/s"},
        3.0,
        (2.0, 1.0),
        0,
        0.01,
        {"J": 0.02, "b": 0.05},
    ),
)

EFFECTS = ("none", "coulomb", "bias", "dead zone", "drag")
DRIVES = ("steps", "sine", "constant", "zero", "standstill", "late", "noise")
ROLES: tuple[Role, Role] = ("estimation", "validation")
FLAWS = ("quantised", "gaps", "short", "far", "first constant", "uneven", "dead sensor", "lone gap")


@dataclass(frozen=True)
class Draw:
    seed: int
    machine: Machine
    effect: str
    drives: tuple[str, ...]
    noise: float
    flaws: frozenset[str]
    roles: tuple[Role, ...]
    lengths: tuple[int, ...]
    parameters: dict[str, Any] = field(default_factory=dict)

    @property
    def complete(self) -> bool:
        """Whether the model is the machine, and can be: its parameters may reach the true ones, and its sensors measure."""
        broken = self.flaws & {"dead sensor", "first constant"} and any(d != "zero" for d in self.drives)
        return self.effect == "none" and not broken

    def data(self) -> DataSet:
        rng = np.random.default_rng([self.seed, 1])
        recordings = [self._recording(rng, e) for e in range(len(self.roles))]
        return DataSet(recordings, name=f"draw {self.seed}", parameters=self.parameters)

    def _recording(self, rng: np.random.Generator, e: int) -> Recording:
        m, n = self.machine, self.lengths[e]
        inputs = [driven(rng, self.drives[e], n, m.step) * m.drive]
        inputs += [0.02 * driven(rng, "sine", n, m.step) for _ in m.inputs[1:]]
        start = np.array(m.reach) * rng.normal(0, 0.3, len(m.reach))
        if self.drives[e] in ("zero", "standstill", "late"):
            start[:] = 0.0
        if "far" in self.flaws:
            start *= 50.0
        states = integrated(m, np.array(inputs), start, self.effect)
        signals: dict[str, np.ndarray] = dict(zip(m.inputs, inputs, strict=True))
        for name, k in m.outputs:
            signals[name] = self._sensed(rng, states[:, k], m.reach[k], e)
        return Recording.from_arrays(f"run {e + 1}", signals, sample_time=m.step, role=self.roles[e], units=m.units)

    def _sensed(self, rng: np.random.Generator, y: np.ndarray, reach: float, e: int) -> np.ndarray:
        y = y + rng.normal(0, self.noise * reach, len(y))
        if "quantised" in self.flaws:
            step = 0.02 * reach
            y = step * np.round(y / step)
        if "first constant" in self.flaws and e == 0:
            y = np.full(len(y), y[0])
        if "dead sensor" in self.flaws:
            y = np.zeros(len(y))
        if "gaps" in self.flaws:
            y[rng.random(len(y)) < 0.2] = np.nan
        if "lone gap" in self.flaws:
            y[len(y) // 3 : len(y) // 2] = np.nan
        return y


def draw(seed: int, least: int = 200, most: int = 1500) -> Draw:
    rng, machine = np.random.default_rng([seed, 0]), MACHINES[seed % len(MACHINES)]
    count = int(rng.integers(1, 4))
    roles: tuple[Role, ...] = ("estimation", *(ROLES[int(rng.integers(2))] for _ in range(count - 1)))
    n, flaws = int(rng.integers(least, most)), frozenset(f for f in FLAWS if rng.random() < 0.08)
    lengths = [n] * count
    if "uneven" in flaws:
        lengths = [int(rng.integers(least, most)) for _ in range(count)]
    if "short" in flaws:
        lengths[-1] = int(rng.integers(8, 40))
    kinds = ("steps", "sine", "noise") if rng.random() < 0.6 else DRIVES
    drives = tuple(str(rng.choice(kinds)) for _ in range(count))
    parameters: dict[str, Any] = {}
    kind = rng.random()
    if kind < 0.08:
        parameters = {n: {"value": v, "fixed": True} for n, v in machine.free.items()}  # nothing free
    elif kind < 0.16:
        parameters = {n: {"value": v, "lower": v, "upper": 2 * v} for n, v in machine.free.items()}
    elif kind < 0.24:
        name = list(machine.free)[-1]
        parameters = {name: {"value": 0.0}}
    elif kind < 0.5:
        parameters = {n: {"value": v * float(rng.uniform(0.5, 2))} for n, v in machine.free.items()}
    return Draw(
        seed,
        machine,
        str(rng.choice(EFFECTS, p=[0.4, 0.15, 0.15, 0.15, 0.15])),
        drives,
        float(rng.choice([0.0, 1e-12, 1e-6, 1e-3, 0.01, 0.1, 1.0], p=[0.05, 0.1, 0.1, 0.3, 0.25, 0.15, 0.05])),
        flaws,
        roles,
        tuple(lengths),
        parameters,
    )


def driven(rng: np.random.Generator, kind: str, n: int, step: float) -> np.ndarray:
    """An input of size one (n,)."""
    t = step * np.arange(n)
    steps = np.repeat(rng.uniform(-1, 1, n // 20 + 1), 20)[:n]
    if kind == "sine":
        w = 2 * math.pi / (step * 100)
        return 0.6 * np.sin(w * t * (1 + 0.3 * t / t[-1]) + rng.uniform(0, 6)) + 0.3 * np.sin(2.7 * w * t)
    if kind == "noise":
        return rng.normal(0, 0.7, n)
    if kind == "constant":
        return np.full(n, 0.6)
    if kind == "zero":
        return np.zeros(n)
    if kind == "standstill":
        return np.where(np.arange(n) > 0.8 * n, steps, 0.0)
    if kind == "late":
        return np.where((np.arange(n) > 0.2 * n) & (np.arange(n) < 0.5 * n), steps, 0.0)
    return steps


def integrated(m: Machine, u: np.ndarray, start: np.ndarray, effect: str) -> np.ndarray:
    """States (N, n_x) of the machine with an effect, by Runge-Kutta steps; its inputs (n_u, N) constant between samples."""
    parts, v0 = 4, 0.05 * m.reach[m.speed]
    h, x = m.step / parts, [float(v) for v in start]
    force = (0.03 if "Rotor" in m.name else 0.2 if len(m.reach) == 2 else 0.05) * m.drive

    def extra(x: list[float]) -> float:
        v = x[m.speed]
        if effect == "coulomb":
            return -force * math.tanh(max(-300.0, min(300.0, v / v0)))
        if effect == "bias":
            return force
        if effect == "drag":
            return -force * v * abs(v) / m.reach[m.speed] ** 2
        return 0.0

    def rate(x: list[float], v: list[float]) -> list[float]:
        return m.rate(x, v, extra(x))

    states = np.empty((u.shape[1], len(x)))
    for i, column in enumerate(u.T.tolist()):
        states[i] = x
        v = list(column)
        if effect == "dead zone":
            v[0] = math.copysign(max(abs(v[0]) - 0.2 * m.drive, 0.0), v[0])
        for _ in range(parts):
            k1 = rate(x, v)
            k2 = rate([a + h / 2 * b for a, b in zip(x, k1, strict=True)], v)
            k3 = rate([a + h / 2 * b for a, b in zip(x, k2, strict=True)], v)
            k4 = rate([a + h * b for a, b in zip(x, k3, strict=True)], v)
            x = [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(x, k1, k2, k3, k4, strict=True)]
    return states
