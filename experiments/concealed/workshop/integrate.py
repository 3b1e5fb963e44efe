"""One experiment of a machine of the workshop: the classical Runge-Kutta rule on fine steps, dry friction and impacts by impulses.

Dry friction: within a step it takes as much of the rate at its port as its level allows, to standstill at most (J. J. Moreau's
implicit step); what a force does to the rates follows from the machine's own equations, so that coupled inertias are right.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp

import numpy as np
from numpy.random import Generator

from experiments.concealed.workshop.laws import Bristle, Dry, Impact, Smooth
from experiments.concealed.workshop.plant import Array, Concealed, Drive, Machine

SLOPE = 0.3
"""Share of the newest difference in the controller's estimate of a rate."""


@dataclass(frozen=True)
class Experiment:
    """inputs (samples, inputs), outputs (samples, outputs), in the model's units; states (samples, states)."""

    inputs: Array
    outputs: Array
    states: Array


def simulate(
    machine: Machine,
    p: Mapping[str, float],
    drive: Drive,
    concealed: Concealed,
    *,
    start: Sequence[float],
    noise: Array,
    resolution: Sequence[float],
    replay: Array | None = None,
    substeps: int | None = None,
) -> Experiment:
    """Simulate under feedback of what the sensors show, or on the inputs `replay`. `noise` (samples, outputs), the model's units."""
    plant = _Plant(machine, p, concealed, list(start), substeps or machine.substeps)
    samples = len(drive.feedforward) if replay is None else len(replay)
    inputs = np.empty((samples, len(machine.inputs)))
    outputs, states = np.empty((samples, len(machine.outputs))), np.empty((samples, len(machine.states)))
    slope, before = np.zeros(len(drive.followed)), None
    for k in range(samples):
        shown = np.array(plant.sense()) + noise[k]
        outputs[k] = [r * round(y / r) if r > 0 else y for y, r in zip(shown, resolution, strict=True)]
        states[k] = plant.state[: len(machine.states)]
        if replay is not None:
            inputs[k] = replay[k]
        else:
            seen = outputs[k][list(drive.followed)]
            before = seen if before is None else before
            slope += SLOPE * ((seen - before) / machine.sample_time - slope)
            inputs[k] = drive.feedforward[k]
            if drive.followed:
                inputs[k] += np.array(drive.gain) * (drive.reference[k] - seen) - np.array(drive.speed_gain) * slope
            before = seen
        plant.advance(list(inputs[k]))
    return Experiment(inputs, outputs, states)


class _Plant:
    """The state of machine, laws, actuators and sensors, and one sample's step of it."""

    def __init__(self, machine: Machine, p: Mapping[str, float], hidden: Concealed, start: list[float], n: int) -> None:
        self.machine, self.p, self.hidden, self.n = machine, p, hidden, n
        self.width = machine.sample_time / n
        self.size = len(start)
        self.bristles = [(machine.ports[name], name, law) for name, law in hidden.laws if isinstance(law, Bristle)]
        self.smooth = [(machine.ports[name], name, law) for name, law in hidden.laws if isinstance(law, Smooth)]
        self.dry = [(machine.ports[name], name, law) for name, law in hidden.laws if isinstance(law, Dry)]
        self.walls = [(machine.ports[name], name, law) for name, law in hidden.laws if isinstance(law, Impact)]
        self.state = [*start, *([0.0] * len(self.bristles))]
        self.none = dict.fromkeys(machine.ports, 0.0)
        self.time = 0.0
        self.commands: list[list[float]] = []
        self.filtered: list[float] | None = None
        self.shown = [list(machine.show(start, p))]
        self.slow = list(self.shown[0])

    def sense(self) -> list[float]:
        """What the sensors show now, with their own delay, lag, gain and bias."""
        found = []
        for i, channel in enumerate(self.machine.outputs):
            change = self.hidden.sensors.get(channel.name, {})
            value = self.slow[i] if "lag" in change else self.shown[-1][i]
            if "delay" in change:
                back = change["delay"] / self.width
                whole = int(back)
                late, later = (self.shown[max(len(self.shown) - 1 - whole - j, 0)][i] for j in (0, 1))
                value = late + (back - whole) * (later - late)
            found.append(change.get("gain", 1.0) * value + change.get("bias", 0.0))
        return found

    def advance(self, command: list[float]) -> None:
        """One sample."""
        self.commands.append(command)
        for step in range(self.n):
            u = self._acting(step)
            self._integrate(u)
            self._impulses(u)
            self.time += self.width
            self._look()

    def _acting(self, step: int) -> list[float]:
        """What the actuators make of the commands, on average over one step."""
        k = len(self.commands) - 1
        wanted = []
        for i, channel in enumerate(self.machine.inputs):
            change = self.hidden.actuators.get(channel.name, {})
            late = round(change.get("delay", 0.0) / self.width)
            value = self.commands[max((k * self.n + step - late) // self.n, 0)][i]
            dead, limit = change.get("dead", 0.0), change.get("limit", float("inf"))
            value = change.get("gain", 1.0) * (value - min(max(value, -dead), dead)) + change.get("bias", 0.0)
            wanted.append(min(max(value, -limit), limit))
        if self.filtered is None:
            self.filtered = list(wanted)
        acting = []
        for i, channel in enumerate(self.machine.inputs):
            lag = self.hidden.actuators.get(channel.name, {}).get("lag", 0.0)
            if lag <= 0.0:
                acting.append(wanted[i])
                continue
            kept = exp(-self.width / lag)
            off = self.filtered[i] - wanted[i]
            acting.append(wanted[i] + off * (1.0 - kept) * lag / self.width)
            self.filtered[i] = wanted[i] + off * kept
        return acting

    def _rates(self, s: list[float], u: list[float], time: float) -> list[float]:
        f = dict(self.none)
        for port, name, law in self.smooth:
            f[name] += port.sign * law.force(port.position(s, self.p), port.rate(s, self.p), time)
        memory = []
        for i, (port, name, law) in enumerate(self.bristles):
            z, v = s[self.size + i], port.rate(s, self.p)
            f[name] += port.sign * law.force(z, v)
            memory.append(law.rate(z, v))
        return [*self.machine.rates(s[: self.size], u, self.p, f), *memory]

    def _integrate(self, u: list[float]) -> None:
        h, s, t = self.width, self.state, self.time
        a = self._rates(s, u, t)
        b = self._rates([x + 0.5 * h * r for x, r in zip(s, a, strict=True)], u, t + 0.5 * h)
        c = self._rates([x + 0.5 * h * r for x, r in zip(s, b, strict=True)], u, t + 0.5 * h)
        d = self._rates([x + h * r for x, r in zip(s, c, strict=True)], u, t + h)
        self.state = [x + h / 6.0 * (i + 2.0 * (j + k) + m) for x, i, j, k, m in zip(s, a, b, c, d, strict=True)]

    def _impulses(self, u: list[float]) -> None:
        for port, name, law in self.dry:
            v = port.rate(self.state, self.p)
            most = self.width * law.level(port.position(self.state, self.p), v, self.time)
            self._push(u, port, name, v, most)
        for port, name, law in self.walls:
            v = port.rate(self.state, self.p)
            if port.position(self.state, self.p) > law.limit and v > 0.0:
                self._push(u, port, name, (1.0 + law.restitution) * v, float("inf"))

    def _push(self, u: list[float], port: object, name: str, change: float, most: float) -> None:
        """Take `change` off the rate at a port, by an impulse of at most `most`."""
        own = self.machine.ports[name]
        s = self.state[: self.size]
        still = self.machine.rates(s, u, self.p, self.none)
        pushed = self.machine.rates(s, u, self.p, {**self.none, name: own.sign})
        answer = [after - before for after, before in zip(pushed, still, strict=True)]
        # what a unit of resisting force does to the rate at the port: rates are linear in the speeds
        moved = own.rate([x + r for x, r in zip(s, answer, strict=True)], self.p) - own.rate(s, self.p)
        impulse = min(max(-change / moved, -most), most)
        slower = [x + impulse * r for x, r in zip(s, answer, strict=True)]
        if most < float(
            "inf"
        ):  # friction acts all through the step: positions are half a step behind, or what sticks would creep
            behind = zip(self.machine.rates(slower, u, self.p, self.none), still, answer, strict=True)
            half = 0.5 * self.width
            slower = [
                x + half * (after - before) * (r == 0.0) for x, (after, before, r) in zip(slower, behind, strict=True)
            ]
        self.state[: self.size] = slower

    def _look(self) -> None:
        shown = list(self.machine.show(self.state[: self.size], self.p))
        self.shown.append(shown)
        for i, channel in enumerate(self.machine.outputs):
            lag = self.hidden.sensors.get(channel.name, {}).get("lag", 0.0)
            self.slow[i] += (1.0 - exp(-self.width / lag)) * (shown[i] - self.slow[i]) if lag > 0 else 0.0


def noise_of(rng: Generator, sigma: Sequence[float], samples: int) -> Array:
    """White noise (samples, outputs)."""
    return np.array(sigma) * rng.standard_normal((samples, len(sigma)))
