"""Dry friction as a set-valued law: the body truly stands still while the other forces stay below the level.

    force = - level sign(v) where v is not zero, and whatever keeps the body at rest, up to +- level, where it is

After every step of the integrator the speed is brought towards zero by what friction takes within the step, to standstill at most:
v = sign(v*) max(|v*| - level width / inertia, 0). That is the implicit step of the differential inclusion, exact for sliding and for
sticking, with no smoothing and no events to find.

J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988; Stribeck level after B. Armstrong-Helouvry,
P. Dupont and C. Canudas de Wit, Automatica 30(7), 1994.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from experiments.concealed.laws.base import Array, Instant, Law


class DryFriction(Law):
    """Base: the level may depend on the speed and on time."""

    places: ClassVar[tuple[str, ...]] = ("dry",)

    def level(self, time: float, v: Array) -> Array:
        """Friction force while sliding with speed v, N m or N; not negative."""
        raise NotImplementedError

    def hold(self, time: float, state: Array, width: float, inertia: Array) -> None:
        v = state[self.speed_row, self.lanes]
        taken = width * self.level(time, v) / inertia[self.lanes]
        state[self.speed_row, self.lanes] = np.sign(v) * np.maximum(np.abs(v) - taken, 0.0)


class DryCoulomb(DryFriction):
    """`level`, whatever the speed."""

    def level(self, time: float, v: Array) -> Array:
        return self["level"]


class DryStribeck(DryFriction):
    """level + extra exp(-(v / v_s)^2): more is needed to break away than to go on."""

    def level(self, time: float, v: Array) -> Array:
        return self["level"] + self["extra"] * np.exp(-((v / self["v_s"]) ** 2))


class DryWarmup(DryFriction):
    """change exp(-t / T), from a cold start at every recording."""

    def level(self, time: float, v: Array) -> Array:
        return self["change"] * np.exp(-max(time, 0.0) / self["T"])


class DryPresliding(Law):
    """Set-valued friction on an elastic seat: the seat gives by z, |z| <= level / stiffness, before the body slides.

    force = - (stiffness z + damping dz/dt), dz/dt = v while the seat gives and zero while it slides: the Prandtl element (L. Prandtl,
    ZAMM 8, 1928), the single cell of Maxwell-slip models, with its edge where the smooth bristle models have a bend.
    """

    places: ClassVar[tuple[str, ...]] = ("body", "dry")
    memory: ClassVar[int] = 1

    def apply(self, motion: Instant) -> None:
        v, z = motion.speed(self.port, self.lanes), motion.state[self.first_row, self.lanes]
        gives = (np.abs(z) < self["level"] / self["stiffness"]) | (z * v < 0.0)
        motion.rates[self.first_row, self.lanes] = np.where(gives, v, 0.0)
        motion.push(self.port, self.lanes, -(self["stiffness"] * z + np.where(gives, self["damping"] * v, 0.0)))

    def hold(self, time: float, state: Array, width: float, inertia: Array) -> None:
        most = self["level"] / self["stiffness"]
        state[self.first_row, self.lanes] = np.clip(state[self.first_row, self.lanes], -most, most)


class HardStop(Law):
    """A stop that is hit: past `limit` on `side` the speed turns round, times `restitution` (Newton's law of impacts).

    For machines whose state is one body's position and speed.
    """

    places: ClassVar[tuple[str, ...]] = ("dry",)

    def hold(self, time: float, state: Array, width: float, inertia: Array) -> None:
        row, side = self.speed_row - 1, self["side"]
        q, v = state[row, self.lanes], state[self.speed_row, self.lanes]
        hit = (side * q > self["limit"]) & (side * v > 0.0)
        state[self.speed_row, self.lanes] = np.where(hit, -self["restitution"] * v, v)
        state[row, self.lanes] = np.where(hit, side * self["limit"], q)
