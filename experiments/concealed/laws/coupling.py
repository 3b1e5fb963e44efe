"""Laws of the two couplings: `self.port` is "gear_spring" or "arm_spring"."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.laws.base import Array, Law, Motion


class Coupling(Law):
    """Base: the coupling's deflection, rate and torque, by the port's name."""

    places: ClassVar[tuple[str, ...]] = ("coupling",)

    @property
    def name(self) -> str:
        return self.port.removesuffix("_spring")

    def deflection(self, m: Motion) -> NDArray[np.float64]:
        return m.state[0 if self.name == "gear" else 1, self.lanes]

    def rate(self, m: Motion) -> Array:
        return getattr(m, f"{self.name}_rate")[self.lanes]

    def add_torque(self, m: Motion, torque: Array) -> None:
        """Positive torque restores a positive deflection."""
        getattr(m, f"{self.name}_torque")[self.lanes] += torque
        if self.name == "gear":
            m.gear_spring[self.lanes] += torque


class Backlash(Coupling):
    """The spring sees the deflection less a dead zone of +- half_gap; the damper (oil, not contact) works in the gap too."""

    places: ClassVar[tuple[str, ...]] = ("deflection",)

    def apply(self, motion: Motion) -> None:
        d = self.deflection(motion)
        getattr(motion, f"{self.name}_deflection")[self.lanes] = d - np.clip(d, -self["half_gap"], self["half_gap"])


class BacklashWithImpacts(Backlash):
    """The same dead zone with nothing in the gap: the damper, too, works in contact alone, and the flanks hit each other."""

    def apply(self, motion: Motion) -> None:
        super().apply(motion)
        contact = np.abs(self.deflection(motion)) > self["half_gap"]
        getattr(motion, f"{self.name}_rate")[self.lanes] *= contact


class TransmissionError(Coupling):
    """Kinematic offset of the gear, d = q_m + E(q_m) - q_g with E = amplitude sin(order q_m + phase).

    By virtual work the motor feels (1 + dE/dq_m) times the gear torque, so that the error neither makes nor loses energy.
    """

    places: ClassVar[tuple[str, ...]] = ("deflection",)

    def apply(self, motion: Motion) -> None:
        angle = self["order"] * motion.position("motor", self.lanes) + self["phase"]
        slope = self["amplitude"] * self["order"] * np.cos(angle)
        motion.gear_deflection[self.lanes] += self["amplitude"] * np.sin(angle)
        motion.gear_rate[self.lanes] += slope * motion.motor_speed[self.lanes]
        motion.gear_ratio[self.lanes] += slope


class CubicStiffness(Coupling):
    """+ cubic d^3."""

    def apply(self, motion: Motion) -> None:
        self.add_torque(motion, self["cubic"] * self.deflection(motion) ** 3)


class SofteningSpring(Coupling):
    """+ level tanh(d / d_0): stiff at first, softer where it is wound up."""

    def apply(self, motion: Motion) -> None:
        self.add_torque(motion, self["level"] * np.tanh(self.deflection(motion) / self["d_0"]))


class WavySpring(Coupling):
    """Outside the library: a torque that changes sign along the deflection, height sin(d / spacing)."""

    def apply(self, motion: Motion) -> None:
        self.add_torque(motion, self["height"] * np.sin(self.deflection(motion) / self["spacing"]))


class HystereticSpring(Coupling):
    """Bouc-Wen hysteron: dz/dt = (r - |r| z |z| / yield^2), torque stiffness z, with r the rate of deflection.

    R. Bouc 1967, Y. K. Wen 1976, with exponent 2: |z| stays below `yield`, where the joint slips.
    """

    memory: ClassVar[int] = 1

    def apply(self, motion: Motion) -> None:
        r, z = self.rate(motion), motion.state[self.first_row, self.lanes]
        motion.rates[self.first_row, self.lanes] = r - np.abs(r) * z * np.abs(z) / self["yield"] ** 2
        self.add_torque(motion, self["stiffness"] * z)


class BoucWen(Coupling):
    """dz/dt = r - (share |r| z + (1 - share) r |z|) |z|^(power - 1) / yield^power, torque stiffness z.

    Y. K. Wen, "Method for random vibration of hysteretic systems", J. Eng. Mech. Div. 102, 1976: loops that open otherwise on the way
    out than back (share below one) and yield softly (power one) or sharply (three).
    """

    memory: ClassVar[int] = 1

    def apply(self, motion: Motion) -> None:
        r, z = self.rate(motion), motion.state[self.first_row, self.lanes]
        bent = self["share"] * np.abs(r) * z + (1.0 - self["share"]) * r * np.abs(z)
        softer = bent * np.abs(z) ** (self["power"] - 1.0) / self["yield"] ** self["power"]
        motion.rates[self.first_row, self.lanes] = r - softer
        self.add_torque(motion, self["stiffness"] * z)


class QuadraticDamping(Coupling):
    """+ c r |r|, r the rate of deflection."""

    def apply(self, motion: Motion) -> None:
        r = self.rate(motion)
        getattr(motion, f"{self.name}_torque")[self.lanes] += self["c"] * r * np.abs(r)


class SpeedTunedDamping(Coupling):
    """Outside the library: a damper that wakes around one motor speed, + c exp(-((|w_m| - center) / width)^2 / 2) r."""

    def apply(self, motion: Motion) -> None:
        w = np.abs(motion.motor_speed[self.lanes])
        share = np.exp(-0.5 * ((w - self["center"]) / self["width"]) ** 2)
        getattr(motion, f"{self.name}_torque")[self.lanes] += self["c"] * share * self.rate(motion)
