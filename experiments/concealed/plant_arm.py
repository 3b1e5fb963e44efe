"""The plant: one axis of an industrial robot arm as three masses in a row (motor, gearbox, arm).

    J a_m dw_m/dt             = u - friction(w_m) - r T_g
    J a_g dw_g/dt             = T_g - T_a
    J (1 - a_m - a_g) dw_a/dt = T_a
    T_g = k_g1 d + k_g3 d^3 + d_g dd/dt,  d = gear twist q_m - q_g
    T_a = k_a e + d_a de/dt,              e = arm twist q_g - q_a
    friction(w) = F_v w + (F_c + F_cs / cosh(alpha w)) tanh(beta w)

E. Wernholt and S. Gunnarsson, "Nonlinear identification of a physically parameterized robot model", IFAC SYSID 2006.
The ratio r is 1 unless a law of `laws.py` bends the gear's kinematics. Angles are radians on the motor side, torques N m.

Many recordings run side by side: every quantity is an array over lanes (one lane = one experiment of one case), and a
law acts on the lanes that it was given. The integrator is the explicit midpoint rule with eight steps in a sample.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.laws import Law, Motion
from experiments.concealed.laws.base import BODIES, by_place

Array = NDArray[np.float64]

PARAMETERS = ("F_v", "F_c", "F_cs", "alpha", "beta", "J", "a_m", "a_g", "k_g1", "k_g3", "d_g", "k_a", "d_a")

# Friction and J as published; the other seven at the optimum of the published recordings.
NOMINAL = {
    "F_v": 0.00986346744839, "F_c": 0.74302635727901, "F_cs": 3.98628540790595, "alpha": 3.24015074090438,
    "beta": 0.79943497008153, "J": 0.03291699877416, "a_m": 0.26631, "a_g": 0.63, "k_g1": 19.985, "k_g3": 24.265,
    "d_g": 0.030811, "k_a": 11.407, "d_a": 0.0028,
}  # fmt: skip

SAMPLE_TIME = 0.0005
STEPS_PER_SAMPLE = 8
STATE_ROWS = 6  # gear twist, arm twist, motor, gearbox and arm speed, motor position


@dataclass(frozen=True)
class Drive:
    """What the cabinet does on each lane: feed-forward torque, speed reference, speed feedback, noise of the sensor, and the step in which
    the speed is read out [rad/s] (0: none).

    Arrays have shape (samples, lanes) or (lanes,). The command is
    u_k = feedforward_k + gain (reference_k - y_k) + integral_gain * sum of past (reference - y) * sample time.
    """

    feedforward: Array
    reference: Array
    noise: Array
    gain: Array
    integral_gain: Array
    resolution: float = 0.0


@dataclass(frozen=True)
class Recordings:
    """Commanded torque and recorded motor speed, (samples, lanes), and the true motor position at the samples."""

    torque: Array
    speed: Array
    position: Array


class ArmPlant:
    """The arm on many lanes, with the laws that are concealed in some of them."""

    def __init__(
        self,
        parameters: Mapping[str, Array],
        laws: Sequence[Law] = (),
        *,
        sample_time: float = SAMPLE_TIME,
        steps_per_sample: int = STEPS_PER_SAMPLE,
        start_time: float = 0.0,
    ) -> None:
        self.parameters = {name: np.atleast_1d(np.asarray(parameters[name], float)) for name in PARAMETERS}
        self.lanes = len(self.parameters["J"])
        self.laws = list(laws)
        self.sample_time = sample_time
        self.steps_per_sample = steps_per_sample
        self.start_time = start_time
        self.rows = STATE_ROWS
        for law in self.laws:
            law.first_row, law.sample_time, law.step = self.rows, sample_time, sample_time / steps_per_sample
            law.speed_row = 2 + (BODIES.index(law.port) if law.port in BODIES else 0)
            self.rows += law.memory
        p = self.parameters
        self._motor_inertia = p["J"] * p["a_m"]
        self._gearbox_inertia = p["J"] * p["a_g"]
        self._arm_inertia = p["J"] * (1.0 - p["a_m"] - p["a_g"])
        self._inertias: dict[str, Array] = dict(
            zip(BODIES, (self._motor_inertia, self._gearbox_inertia, self._arm_inertia), strict=True)
        )
        self._by_place = by_place(self.laws)

    def initial_state(self, speeds: Array) -> Array:
        """States (rows, lanes) with untwisted springs, position zero, and `speeds` (3, lanes) [rad/s]."""
        state = np.zeros((self.rows, self.lanes))
        state[2:5] = speeds
        for law in self.laws:
            law.start(state)
        return state

    def motion(self, time: float, state: Array, torque: Array) -> Motion:
        """Everything that the laws can see and change at one instant, all forces evaluated."""
        p, laws = self.parameters, self._by_place
        m = Motion(time, state, torque)
        for law in laws.get("input", ()):
            law.apply(m)
        for law in laws.get("deflection", ()):
            law.apply(m)
        d = m.gear_deflection
        m.gear_spring = d * (p["k_g1"] + p["k_g3"] * d * d)
        m.gear_torque = m.gear_spring + p["d_g"] * m.gear_rate
        m.arm_torque = p["k_a"] * m.arm_deflection + p["d_a"] * m.arm_rate
        for law in laws.get("coupling", ()):
            law.apply(m)
        w = m.motor_speed
        m.motor_force = -p["F_v"] * w - (p["F_c"] + p["F_cs"] / np.cosh(p["alpha"] * w)) * np.tanh(p["beta"] * w)
        for law in laws.get("body", ()):
            law.apply(m)
        return m

    def rates(self, time: float, state: Array, torque: Array) -> Array:
        """Time derivative of the states, (rows, lanes)."""
        m = self.motion(time, state, torque)
        rates = m.rates
        rates[0] = m.motor_speed - m.gearbox_speed
        rates[1] = m.gearbox_speed - m.arm_speed
        rates[2] = (m.torque + m.motor_force - m.gear_ratio * m.gear_torque) / self._motor_inertia
        rates[3] = (m.gear_torque - m.arm_torque + m.gearbox_force) / self._gearbox_inertia
        rates[4] = (m.arm_torque + m.arm_force) / self._arm_inertia
        rates[5] = m.motor_speed
        return rates

    def _hold(self, time: float, state: Array, width: float) -> None:
        for law in self._by_place.get("dry", ()):
            law.hold(time, state, width, self._inertias[law.port])

    def energy(self, state: Array) -> Array:
        """Kinetic energy and that of the two springs, without any law's share [J], per lane."""
        p = self.parameters
        d, e = state[0], state[1]
        kinetic = self._motor_inertia * state[2] ** 2 + self._gearbox_inertia * state[3] ** 2
        kinetic = kinetic + self._arm_inertia * state[4] ** 2
        return 0.5 * (kinetic + p["k_g1"] * d**2 + 0.5 * p["k_g3"] * d**4 + p["k_a"] * e**2)

    def run(
        self,
        state: Array,
        drive: Drive,
        *,
        observe: Callable[[int, Array], None] | None = None,
        overflow: bool = False,
    ) -> Recordings:
        """Run all lanes through the drive's samples from `state` (rows, lanes).

        `observe` is called with the number of every sample and the state there. A simulation that overflows raises
        FloatingPointError, unless `overflow` is true: then its lanes are NaN from there on.
        """
        samples = len(drive.feedforward)
        torque, speed, position = (np.empty((samples, self.lanes)) for _ in range(3))
        integral = np.zeros(self.lanes)
        step = self.sample_time / self.steps_per_sample
        timing = self._by_place.get("input_time", [])
        sensing = self._by_place.get("output", [])
        error_gain = drive.integral_gain * self.sample_time
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # cosh of a fast speed: the term it divides is zero then, as it should be
            for k in range(samples):
                measured = state[2].copy()
                for law in sensing:
                    law.measure(measured, state)
                measured += drive.noise[k]
                if drive.resolution > 0.0:
                    measured = drive.resolution * np.round(measured / drive.resolution)
                error = drive.reference[k] - measured
                torque[k] = drive.feedforward[k] + drive.gain * error + integral
                speed[k], position[k] = measured, state[5]
                if observe is not None:
                    observe(k, state)
                integral += error_gain * error
                effective = torque[k]
                for j in range(self.steps_per_sample):
                    time = self.start_time + k * self.sample_time + j * step
                    if timing:
                        effective = torque[k].copy()
                        for law in timing:
                            law.retime(effective, torque, k, j / self.steps_per_sample, 1.0 / self.steps_per_sample)
                    middle = state + (0.5 * step) * self.rates(time, state, effective)
                    self._hold(time, middle, 0.5 * step)
                    state = state + step * self.rates(time + 0.5 * step, middle, effective)
                    self._hold(time, state, step)
                    for law in sensing:
                        law.remember(state)
        if not overflow and not np.isfinite(speed).all():
            lost = sorted(set(np.nonzero(~np.isfinite(speed))[1].tolist()))
            raise FloatingPointError(f"the simulation overflowed on lanes {lost}")
        return Recordings(torque, speed, position)
