"""What a law sees (the motion of all lanes at one instant) and what a law is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BODIES = ("motor", "gearbox", "arm")


class Motion:
    """One instant of all lanes: kinematics to read, forces to add to. Every attribute is an array over lanes."""

    motor_force: Array
    gear_spring: Array  # elastic part of the gear torque: the load that the motor feels
    gear_torque: Array
    arm_torque: Array

    def __init__(self, time: float, state: Array, torque: Array) -> None:
        lanes = state.shape[1]
        self.time = time
        self.state = state
        self.rates = np.zeros_like(state)
        self.torque = torque.copy()
        self.motor_speed, self.gearbox_speed, self.arm_speed = state[2], state[3], state[4]
        self.gear_deflection = state[0].copy()
        self.gear_rate = state[2] - state[3]
        self.arm_deflection = state[1].copy()
        self.arm_rate = state[3] - state[4]
        self.gear_ratio = np.ones(lanes)
        self.gearbox_force = np.zeros(lanes)
        self.arm_force = np.zeros(lanes)

    def speed(self, body: str, lanes: NDArray[np.intp]) -> Array:
        """Speed of a body on some lanes, rad/s."""
        return self.state[2 + BODIES.index(body), lanes]

    def position(self, body: str, lanes: NDArray[np.intp]) -> Array:
        """Position of a body on some lanes, rad, zero at the start of the recording for all three bodies."""
        position = self.state[5, lanes]
        if body != "motor":
            position = position - self.state[0, lanes]
        return position - self.state[1, lanes] if body == "arm" else position

    def push(self, body: str, lanes: NDArray[np.intp], force: Array) -> None:
        """Add a force to a body on some lanes; positive pushes it forward, N m."""
        getattr(self, f"{body}_force")[lanes] += force


class Law:
    """One law, acting on `lanes` with its `switches`: strength and shape, each an array over those lanes.

    `places` says when the law is asked: "input_time" (retime), "input", "deflection", "coupling", "body" (apply, in this
    order within an instant), "output" (measure at the samples, remember after every step).
    """

    places: ClassVar[tuple[str, ...]] = ("body",)
    memory: ClassVar[int] = 0  # states of its own

    def __init__(self, lanes: NDArray[np.intp], switches: Mapping[str, Array], port: str) -> None:
        self.lanes = lanes
        self.switches = dict(switches)
        self.port = port
        self.first_row = -1  # set by the plant, as are the next two [s]
        self.sample_time = np.nan
        self.step = np.nan

    def __getitem__(self, name: str) -> Array:
        return self.switches[name]

    def start(self, state: Array) -> None:
        """Set the law's own states at the beginning of the recordings; zero unless overridden."""

    def apply(self, motion: Motion) -> None:
        """Read and change one instant."""
        raise NotImplementedError

    def retime(self, effective: Array, torque: Array, sample: int, phase: float, width: float) -> None:
        """Change which commanded torque acts on [phase, phase + width] of the sample, in units of the sample time."""
        raise NotImplementedError

    def measure(self, measured: Array, state: Array) -> None:
        """Change what the sensor shows."""
        raise NotImplementedError

    def remember(self, state: Array) -> None:
        """Take note of the state after an integration step; for sensors that look back."""
