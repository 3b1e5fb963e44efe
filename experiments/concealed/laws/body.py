"""Forces on one body. `self.port` names the body; friction opposes its motion at every speed.

Switches are per lane; v is the body's speed, q its position from the start of the recording.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from experiments.concealed.laws.base import Array, Instant, Law


class BodyForce(Law):
    """Base of the laws that are one static function of the instant."""

    def force(self, m: Instant, v: Array) -> Array:
        """Force on the body, N m."""
        raise NotImplementedError

    def apply(self, motion: Instant) -> None:
        motion.push(self.port, self.lanes, self.force(motion, motion.speed(self.port, self.lanes)))


class Viscous(BodyForce):
    """- c v."""

    def force(self, m: Instant, v: Array) -> Array:
        return -self["c"] * v


class Coulomb(BodyForce):
    """- level tanh(v / v_0)."""

    def force(self, m: Instant, v: Array) -> Array:
        return -self["level"] * np.tanh(v / self["v_0"])


class Stribeck(BodyForce):
    """- (level + extra exp(-(v / v_s)^2)) tanh(v / v_0) - c v."""

    def force(self, m: Instant, v: Array) -> Array:
        level = self["level"] + self["extra"] * np.exp(-((v / self["v_s"]) ** 2))
        return -level * np.tanh(v / self["v_0"]) - self["c"] * v


class CoulombAsymmetry(BodyForce):
    """- difference |tanh(v / v_0)|: the Coulomb level is higher one way and lower the other by `difference`.

    On its own it drives in one direction; with the plant's Coulomb friction, which is larger, the sum opposes motion.
    """

    def force(self, m: Instant, v: Array) -> Array:
        return -self["difference"] * np.abs(np.tanh(v / self["v_0"]))


class QuadraticDrag(BodyForce):
    """- c v |v|."""

    def force(self, m: Instant, v: Array) -> Array:
        return -self["c"] * v * np.abs(v)


class LoadDependentFriction(BodyForce):
    """- c |load| tanh(v / v_0)."""

    def force(self, m: Instant, v: Array) -> Array:
        return -self["c"] * np.abs(m.load(self.lanes)) * np.tanh(v / self["v_0"])


class PositionDependentFriction(BodyForce):
    """- level (1 + cos(order q + phase)) tanh(v / v_0): never negative, so never driving."""

    def force(self, m: Instant, v: Array) -> Array:
        q = m.position(self.port, self.lanes)
        return -self["level"] * (1.0 + np.cos(self["order"] * q + self["phase"])) * np.tanh(v / self["v_0"])


class FrictionWarmup(BodyForce):
    """- change (exp(-t / T) or 1 - exp(-t / T)) tanh(v / v_0), from a cold start at every recording."""

    def force(self, m: Instant, v: Array) -> Array:
        cold = np.exp(-max(m.time, 0.0) / self["T"])
        share = np.where(self["grows"] > 0, 1.0 - cold, cold)
        return -self["change"] * share * np.tanh(v / self["v_0"])


class ConstantBias(BodyForce):
    """+ bias."""

    def force(self, m: Instant, v: Array) -> Array:
        return self["bias"]


class Gravity(BodyForce):
    """- moment sin(q + angle)."""

    def force(self, m: Instant, v: Array) -> Array:
        return -self["moment"] * np.sin(m.position(self.port, self.lanes) + self["angle"])


class TorqueRipple(BodyForce):
    """amplitude sin(order q + phase)."""

    def force(self, m: Instant, v: Array) -> Array:
        return self["amplitude"] * np.sin(self["order"] * m.position(self.port, self.lanes) + self["phase"])


class EndStop(BodyForce):
    """A spring and a damper past `limit`, which only push back: - max(stiffness x + damping v, 0) where x = q - limit > 0.

    With `side` -1 the stop is at negative positions: x = -q - limit.
    """

    def force(self, m: Instant, v: Array) -> Array:
        depth = self["side"] * m.position(self.port, self.lanes) - self["limit"]
        back = np.maximum(self["stiffness"] * depth + self["damping"] * self["side"] * v, 0.0)
        return -self["side"] * np.where(depth > 0.0, back, 0.0)


class SpeedBump(BodyForce):
    """Outside the library: friction that rises around one speed, - height exp(-((|v| - center) / width)^2 / 2) tanh(v / v_0)."""

    def force(self, m: Instant, v: Array) -> Array:
        bump = np.exp(-0.5 * ((np.abs(v) - self["center"]) / self["width"]) ** 2)
        return -self["height"] * bump * np.tanh(v / self["v_0"])


class SpeedWaves(BodyForce):
    """Outside the library: friction that comes and goes with speed, - height (1 - cos(v / spacing)) / 2 tanh(v / v_0)."""

    def force(self, m: Instant, v: Array) -> Array:
        return -0.5 * self["height"] * (1.0 - np.cos(v / self["spacing"])) * np.tanh(v / self["v_0"])


class Notch(BodyForce):
    """Outside the library: a detent at one position that is passed in every sweep, - gradient of a Gaussian potential."""

    def force(self, m: Instant, v: Array) -> Array:
        x = (m.position(self.port, self.lanes) - self["center"]) / self["width"]
        return -self["height"] * x * np.exp(0.5 - 0.5 * x * x)


class Bristle(Law):
    """LuGre: dz/dt = v - stiffness |v| z / level, force - (stiffness z + damping dz/dt).

    C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, "A new model for control of systems with friction",
    IEEE Trans. Automatic Control 40(3), 1995; constant level, so that damping < 4 level / stiffness / |v| keeps it passive.
    """

    memory: ClassVar[int] = 1

    def start(self, state: Array) -> None:
        v = state[self.speed_row, self.lanes]
        state[self.first_row, self.lanes] = self["level"] / self["stiffness"] * np.tanh(v)

    def apply(self, motion: Instant) -> None:
        v = motion.speed(self.port, self.lanes)
        z = motion.state[self.first_row, self.lanes]
        slip = v - self["stiffness"] * np.abs(v) * z / self["level"]
        motion.rates[self.first_row, self.lanes] = slip
        motion.push(self.port, self.lanes, -(self["stiffness"] * z + self["damping"] * slip))


class StribeckBristle(Bristle):
    """LuGre with a level that falls with speed, level + extra exp(-(v / v_s)^2), and viscous friction c v: as published (see `Bristle`)."""

    def apply(self, motion: Instant) -> None:
        v = motion.speed(self.port, self.lanes)
        z = motion.state[self.first_row, self.lanes]
        level = self["level"] + self["extra"] * np.exp(-((v / self["v_s"]) ** 2))
        slip = v - self["stiffness"] * np.abs(v) * z / level
        motion.rates[self.first_row, self.lanes] = slip
        motion.push(self.port, self.lanes, -(self["stiffness"] * z + self["damping"] * slip + self["c"] * v))


class AdditionalMode(Law):
    """One more mass on a spring and a damper: states deflection x = q_body - q_mass and the mass's speed."""

    memory: ClassVar[int] = 2

    def start(self, state: Array) -> None:
        state[self.first_row + 1, self.lanes] = state[self.speed_row, self.lanes]

    def apply(self, motion: Instant) -> None:
        v = motion.speed(self.port, self.lanes)
        x, w = motion.state[self.first_row, self.lanes], motion.state[self.first_row + 1, self.lanes]
        natural = 2.0 * np.pi * self["frequency"]
        spring = self["inertia"] * (natural**2 * x + 2.0 * self["damping_ratio"] * natural * (v - w))
        motion.rates[self.first_row, self.lanes] = v - w
        motion.rates[self.first_row + 1, self.lanes] = spring / self["inertia"]
        motion.push(self.port, self.lanes, -spring)
