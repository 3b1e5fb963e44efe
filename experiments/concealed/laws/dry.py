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

from experiments.concealed.laws.base import Array, Law


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
