"""What no model of a machine holds and every recording has: small disturbances of the torque, samples taken a little early or late."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.laws.base import Array, Instant, Law


class Disturbance(Law):
    """A force on the driven body that is not recorded, held over each sample: noise of the amplifier, slow drift.

    values (samples, lanes) from `start_time` on [N m or N].
    """

    places: ClassVar[tuple[str, ...]] = ("body",)

    def __init__(self, lanes: NDArray[np.intp], values: Array, port: str, start_time: float) -> None:
        super().__init__(lanes, {}, port)
        self._values, self._start_time = values, start_time

    def apply(self, motion: Instant) -> None:
        sample = int((motion.time - self._start_time) / self.sample_time + 1e-6)
        motion.push(self.port, self.lanes, self._values[min(sample, len(self._values) - 1)])


class Jitter(Law):
    """Samples of the sensor taken `offsets` (samples, lanes) seconds off their time; linear over the last step of the integrator."""

    places: ClassVar[tuple[str, ...]] = ("output",)

    def __init__(self, lanes: NDArray[np.intp], offsets: Array, port: str) -> None:
        super().__init__(lanes, {}, port)
        self._offsets = offsets

    def start(self, state: Array) -> None:
        self._sample = 0
        self._before = self._now = state[self.sensed_row, self.lanes].copy()

    def remember(self, state: Array) -> None:
        self._before, self._now = self._now, state[self.sensed_row, self.lanes].copy()

    def measure(self, measured: Array, state: Array) -> None:
        measured[self.lanes] += self._offsets[self._sample] * (self._now - self._before) / self.step
        self._sample += 1
