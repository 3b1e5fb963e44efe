"""What a law sees (the motion of all lanes at one instant) and what a law is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BODIES = ("motor", "gearbox", "arm")


class Instant:
    """What every machine shows of one instant of all lanes: the time, the states, their rates to add to, the torque (or force) applied."""

    def __init__(self, time: float, state: Array, torque: Array) -> None:
        self.time = time
        self.state = state
        self.rates = np.zeros_like(state)
        self.torque = torque.copy()

    def speed(self, body: str, lanes: NDArray[np.intp]) -> Array:
        """Speed of a body on some lanes, rad/s or m/s."""
        raise NotImplementedError

    def position(self, body: str, lanes: NDArray[np.intp]) -> Array:
        """Position of a body on some lanes, rad or m."""
        raise NotImplementedError

    def load(self, lanes: NDArray[np.intp]) -> Array:
        """What the bearings carry on some lanes: the load that friction may depend on."""
        raise NotImplementedError

    def push(self, body: str, lanes: NDArray[np.intp], force: Array) -> None:
        """Add a force to a body on some lanes; positive pushes it forward, N m or N."""
        raise NotImplementedError


class Motion(Instant):
    """One instant of all lanes of the arm: kinematics to read, forces to add to. Every attribute is an array over lanes."""

    motor_force: Array
    gear_spring: Array  # elastic part of the gear torque: the load that the motor feels
    gear_torque: Array
    arm_torque: Array

    def __init__(self, time: float, state: Array, torque: Array) -> None:
        super().__init__(time, state, torque)
        lanes = state.shape[1]
        self.motor_speed, self.gearbox_speed, self.arm_speed = state[2], state[3], state[4]
        self.gear_deflection = state[0].copy()
        self.gear_rate = state[2] - state[3]
        self.arm_deflection = state[1].copy()
        self.arm_rate = state[3] - state[4]
        self.gear_ratio = np.ones(lanes)
        self.gearbox_force = np.zeros(lanes)
        self.arm_force = np.zeros(lanes)

    def speed(self, body: str, lanes: NDArray[np.intp]) -> Array:
        return self.state[2 + BODIES.index(body), lanes]

    def position(self, body: str, lanes: NDArray[np.intp]) -> Array:
        """Position of a body on some lanes, rad, zero at the start of the recording for all three bodies."""
        position = self.state[5, lanes]
        if body != "motor":
            position = position - self.state[0, lanes]
        return position - self.state[1, lanes] if body == "arm" else position

    def load(self, lanes: NDArray[np.intp]) -> Array:
        return self.gear_spring[lanes]

    def push(self, body: str, lanes: NDArray[np.intp], force: Array) -> None:
        getattr(self, f"{body}_force")[lanes] += force


class Law:
    """One law, acting on `lanes` with its `switches`: strength and shape, each an array over those lanes.

    `places` says when the law is asked: "input_time" (retime), "input", "deflection", "coupling", "body" (apply, in this
    order within an instant), "dry" (hold, once the other forces have moved the states), "output" (measure at the samples, remember
    after every step).
    """

    places: ClassVar[tuple[str, ...]] = ("body",)
    memory: ClassVar[int] = 0  # states of its own
    shows_the_past: ClassVar[bool] = False  # in the place of what is measured: asked before the other laws of a sensor

    def __init__(self, lanes: NDArray[np.intp], switches: Mapping[str, Array], port: str) -> None:
        self.lanes = lanes
        self.switches = dict(switches)
        self.port = port
        self.speed_row = 2  # of the speed of the port's body, set by the plant, as is all that follows
        self.sensed_row = 2  # of what the port's sensor shows
        self.first_row = -1
        self.sample_time = np.nan
        self.step = np.nan

    def __getitem__(self, name: str) -> Array:
        return self.switches[name]

    def start(self, state: Array) -> None:
        """Set the law's own states at the beginning of the recordings; zero unless overridden."""

    def apply(self, motion: Any) -> None:
        """Read and change one instant (an `Instant` of the machine that the law belongs to)."""
        raise NotImplementedError

    def hold(self, time: float, state: Array, width: float, inertia: Array) -> None:
        """Slow the body down by what dry friction takes within `width` seconds, to standstill at most."""
        raise NotImplementedError

    def retime(self, effective: Array, torque: Array, sample: int, phase: float, width: float) -> None:
        """Change which commanded torque acts on [phase, phase + width] of the sample, in units of the sample time."""
        raise NotImplementedError

    def measure(self, measured: Array, state: Array) -> None:
        """Change what the sensor shows."""
        raise NotImplementedError

    def remember(self, state: Array) -> None:
        """Take note of the state after an integration step; for sensors that look back."""


def by_place(laws: Sequence[Law]) -> dict[str, list[Law]]:
    """The laws that are asked at each place, in turn."""
    found: dict[str, list[Law]] = {}
    for law in sorted(laws, key=lambda law: not law.shows_the_past):
        for place in law.places:
            found.setdefault(place, []).append(law)
    return found
