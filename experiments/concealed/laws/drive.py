"""Laws between the recorded input and the motor, and between the motor and the recorded output."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from experiments.concealed.laws.base import Array, Instant, Law


class InputDelay(Law):
    """The held command arrives `delay` seconds late: exactly so, whatever fraction of a sample it is.

    Within an integration step the torque is the mean of the delayed staircase over that step. Before the recording the
    command was its first sample.
    """

    places: ClassVar[tuple[str, ...]] = ("input_time",)

    def retime(self, effective: Array, torque: Array, sample: int, phase: float, width: float) -> None:
        position = sample + phase - self["delay"] / self.sample_time
        first = np.floor(position).astype(int)
        late = np.clip((position + width - first - 1.0) / width, 0.0, 1.0)  # share of the step in the next sample
        now = torque[np.maximum(first, 0), self.lanes]
        after = torque[np.clip(first + 1, 0, sample), self.lanes]
        effective[self.lanes] = (1.0 - late) * now + late * after


class InputMap(Law):
    """Base of the static maps from command to torque."""

    places: ClassVar[tuple[str, ...]] = ("input",)

    def torque(self, m: Instant, u: Array) -> Array:
        raise NotImplementedError

    def apply(self, motion: Instant) -> None:
        motion.torque[self.lanes] = self.torque(motion, motion.torque[self.lanes])


class InputLag(InputMap):
    """First-order lag of the torque: T dx/dt = u - x; at rest before the recording."""

    memory: ClassVar[int] = 1

    def torque(self, m: Instant, u: Array) -> Array:
        x = m.state[self.first_row, self.lanes]
        m.rates[self.first_row, self.lanes] = (u - x) / self["T"]
        return x.copy()


class InputBias(InputMap):
    """u + bias."""

    def torque(self, m: Instant, u: Array) -> Array:
        return u + self["bias"]


class InputGain(InputMap):
    """gain u."""

    def torque(self, m: Instant, u: Array) -> Array:
        return self["gain"] * u


class TorqueSaturation(InputMap):
    """u limited to +- limit."""

    def torque(self, m: Instant, u: Array) -> Array:
        return np.clip(u, -self["limit"], self["limit"])


class ActuatorDeadzone(InputMap):
    """u less a dead zone of +- half_width."""

    def torque(self, m: Instant, u: Array) -> Array:
        return u - np.clip(u, -self["half_width"], self["half_width"])


class TorqueFade(InputMap):
    """Outside the library: torque that fades with speed (weak field, low bus voltage), u (1 - loss (v / top)^2)."""

    def torque(self, m: Instant, u: Array) -> Array:
        v = m.state[self.speed_row, self.lanes]
        return u * (1.0 - self["loss"] * np.minimum((v / self["top"]) ** 2, 1.0))


class OutputDelay(Law):
    """The sensor shows what was `delay` seconds ago, interpolated between integration steps."""

    places: ClassVar[tuple[str, ...]] = ("output",)
    shows_the_past: ClassVar[bool] = True
    _speeds: list[Array]
    _late: Array

    def start(self, state: Array) -> None:
        self._late = self["delay"] / self.step
        depth = int(np.ceil(self._late.max())) + 2
        self._speeds = [state[self.sensed_row, self.lanes].copy() for _ in range(depth)]  # newest last

    def remember(self, state: Array) -> None:
        self._speeds.append(state[self.sensed_row, self.lanes].copy())
        self._speeds.pop(0)

    def measure(self, measured: Array, state: Array) -> None:
        whole = np.floor(self._late).astype(int)
        part = self._late - whole
        history = np.array(self._speeds)
        column = np.arange(len(self.lanes))
        newest = len(history) - 1
        later, earlier = history[newest - whole, column], history[newest - whole - 1, column]
        measured[self.lanes] = (1.0 - part) * later + part * earlier


class SensorLag(Law):
    """First-order lag of what is measured: T dx/dt = y - x."""

    places: ClassVar[tuple[str, ...]] = ("body", "output")
    memory: ClassVar[int] = 1
    shows_the_past: ClassVar[bool] = True

    def start(self, state: Array) -> None:
        state[self.first_row, self.lanes] = state[self.sensed_row, self.lanes]

    def apply(self, motion: Instant) -> None:
        x = motion.state[self.first_row, self.lanes]
        motion.rates[self.first_row, self.lanes] = (motion.state[self.sensed_row, self.lanes] - x) / self["T"]

    def measure(self, measured: Array, state: Array) -> None:
        measured[self.lanes] = state[self.first_row, self.lanes]


class SensorBias(Law):
    """What is measured + bias."""

    places: ClassVar[tuple[str, ...]] = ("output",)

    def measure(self, measured: Array, state: Array) -> None:
        measured[self.lanes] += self["bias"]


class SensorGain(Law):
    """gain times what is measured."""

    places: ClassVar[tuple[str, ...]] = ("output",)

    def measure(self, measured: Array, state: Array) -> None:
        measured[self.lanes] *= self["gain"]
