"""The plant of a machine with one moving body: a carriage on a rail, or a pendulum.

    dq/dt = v
    m dv/dt = u - c v - g sin q + forces of the laws        (g = 0 for a carriage)

Many recordings run side by side, as in `plant_arm.py`: every quantity is an array over lanes, and a law acts on the lanes that it was
given. Explicit midpoint rule with `steps_per_sample` steps in a sample; dry friction by its own implicit step (`laws/dry.py`), so that a
body that sticks stands still.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.laws import Instant, Law
from experiments.concealed.laws.base import by_place

Array = NDArray[np.float64]

STATE_ROWS = 2  # position, speed
SPEED_FILTER = 0.3  # share of the newest difference in the controller's estimate of the speed


@dataclass(frozen=True)
class BodyDrive:
    """What the cabinet does on each lane.

    feedforward, reference (samples, lanes); noise (outputs, samples, lanes); gains (lanes,); resolution (outputs,) of the read-out. The
    command is u_k = feedforward_k + gain (reference_k - y_k) + speed_gain (slope of the reference - slope of y), with y the measured
    position and its slope a filtered difference.
    """

    feedforward: Array
    reference: Array
    noise: Array
    gain: Array
    speed_gain: Array
    resolution: Array


@dataclass(frozen=True)
class BodyRecordings:
    """Commanded force (samples, lanes), recorded outputs (outputs, samples, lanes), true position (samples, lanes)."""

    command: Array
    outputs: Array
    position: Array


class BodyInstant(Instant):
    """One instant of the body on all lanes."""

    def __init__(self, time: float, state: Array, torque: Array, load: Array) -> None:
        super().__init__(time, state, torque)
        self.force = np.zeros(state.shape[1])
        self._load = load

    def speed(self, body: str, lanes: NDArray[np.intp]) -> Array:
        return self.state[1, lanes]

    def position(self, body: str, lanes: NDArray[np.intp]) -> Array:
        return self.state[0, lanes]

    def load(self, lanes: NDArray[np.intp]) -> Array:
        return self._load[lanes]

    def push(self, body: str, lanes: NDArray[np.intp], force: Array) -> None:
        self.force[lanes] += force


class BodyPlant:
    """The body on many lanes: inertia m, damping c, gravity g, each (lanes,). `output_rows`: what its sensors show."""

    def __init__(
        self,
        inertia: Array,
        damping: Array,
        gravity: Array,
        laws: Sequence[Law] = (),
        *,
        output_rows: Sequence[int] = (0,),
        sensors: Sequence[str] = ("sensor",),
        sample_time: float,
        steps_per_sample: int = 10,
        start_time: float = 0.0,
    ) -> None:
        self.inertia, self.damping, self.gravity = (np.atleast_1d(a).astype(float) for a in (inertia, damping, gravity))
        self.lanes = len(self.inertia)
        self.output_rows = tuple(output_rows)
        self.sample_time, self.steps_per_sample, self.start_time = sample_time, steps_per_sample, start_time
        self.rows = STATE_ROWS
        self.laws = list(laws)
        self._by_place = by_place(self.laws)
        for law in self.laws:
            law.first_row, law.sample_time, law.step = self.rows, sample_time, sample_time / steps_per_sample
            law.speed_row = 1
            law.sensed_row = output_rows[sensors.index(law.port)] if law.port in sensors else output_rows[0]
            self.rows += law.memory

    def initial_state(self, position: Array, speed: Array) -> Array:
        """States (rows, lanes), with those of the laws at rest."""
        state = np.zeros((self.rows, self.lanes))
        state[0], state[1] = position, speed
        for law in self.laws:
            law.start(state)
        return state

    def rates(self, time: float, state: Array, command: Array) -> Array:
        """Time derivative of the states, (rows, lanes), without dry friction."""
        pull = self.gravity * np.sin(state[0])
        m = BodyInstant(time, state, command, self.gravity * np.cos(state[0]) + self.inertia * state[1] ** 2)
        for place in ("input", "body"):
            for law in self._by_place.get(place, ()):
                law.apply(m)
        m.rates[0] = state[1]
        m.rates[1] = (m.torque + m.force - self.damping * state[1] - pull) / self.inertia
        return m.rates

    def energy(self, state: Array) -> Array:
        """Kinetic energy and that of gravity, zero at rest hanging [J], per lane."""
        return 0.5 * self.inertia * state[1] ** 2 + self.gravity * (1.0 - np.cos(state[0]))

    def run(
        self, state: Array, drive: BodyDrive, *, observe: Callable[[int, Array], None] | None = None
    ) -> BodyRecordings:
        """Run all lanes through the drive's samples from `state` (rows, lanes). Lanes that overflow end in NaN."""
        samples = len(drive.feedforward)
        command, position = np.empty((samples, self.lanes)), np.empty((samples, self.lanes))
        outputs = np.empty((len(self.output_rows), samples, self.lanes))
        slope = np.zeros(self.lanes)
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(samples):
                outputs[:, k], position[k] = self._measured(state, drive, k), state[0]
                back = max(k - 1, 0)
                slope += SPEED_FILTER * ((outputs[0, k] - outputs[0, back]) / self.sample_time - slope)
                wanted = (drive.reference[k] - drive.reference[back]) / self.sample_time
                error = drive.reference[k] - outputs[0, k]
                command[k] = drive.feedforward[k] + drive.gain * error + drive.speed_gain * (wanted - slope)
                if observe is not None:
                    observe(k, state)
                state = self._advanced(k, state, command)
        return BodyRecordings(command, outputs, position)

    def _measured(self, state: Array, drive: BodyDrive, k: int) -> Array:
        shown = state[list(self.output_rows)].copy()
        for law in self._by_place.get("output", ()):
            law.measure(shown[self.output_rows.index(law.sensed_row)], state)
        shown += drive.noise[:, k]
        fine = drive.resolution[:, None]
        return np.where(fine > 0.0, fine * np.round(shown / np.where(fine > 0.0, fine, 1.0)), shown)

    def _advanced(self, k: int, state: Array, command: Array) -> Array:
        """The state one sample later."""
        step = self.sample_time / self.steps_per_sample
        effective = command[k]
        for j in range(self.steps_per_sample):
            time = self.start_time + k * self.sample_time + j * step
            timing = self._by_place.get("input_time", ())
            if timing:
                effective = command[k].copy()
                for law in timing:
                    law.retime(effective, command, k, j / self.steps_per_sample, 1.0 / self.steps_per_sample)
            middle = state + (0.5 * step) * self.rates(time, state, effective)
            self._hold(time, middle, 0.5 * step)
            state = state + step * self.rates(time + 0.5 * step, middle, effective)
            self._hold(time, state, step)
            for law in self._by_place.get("output", ()):
                law.remember(state)
        return state

    def _hold(self, time: float, state: Array, width: float) -> None:
        for law in self._by_place.get("dry", ()):
            law.hold(time, state, width, self.inertia)
