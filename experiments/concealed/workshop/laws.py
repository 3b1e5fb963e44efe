"""Physics to conceal at a port: what resists the motion there, as a function of position, rate, time and a memory of its own.

A law either gives a force (`force`), or a level of dry friction that truly sticks (`level`: a set-valued law), or a place where the motion
is thrown back (`restitution`). Richer than the library's laws where the world is: D. Stribeck levels under true sticking; LuGre (Canudas de
Wit, Olsson, Astrom, Lischinsky, IEEE TAC 40(3), 1995); Bouc-Wen (Y. K. Wen, J. Eng. Mech. 102, 1976); impacts by Newton's law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import copysign, cos, exp, sin, sqrt

Force = Callable[[float, float, float], float]
"""Of position, rate and time."""


@dataclass(frozen=True)
class Smooth:
    """A force without memory."""

    force: Force


@dataclass(frozen=True)
class Dry:
    """Dry friction that truly sticks; its level, never negative, may depend on position, rate and time."""

    level: Force


@dataclass(frozen=True)
class Bristle:
    """A force with one state: `rate` is that of the state, `force` what it does, both of state and speed."""

    rate: Callable[[float, float], float]
    force: Callable[[float, float], float]


@dataclass(frozen=True)
class Impact:
    """A wall at `limit` (on the upper side) that throws the motion back with a share of its speed."""

    limit: float
    restitution: float


PortLaw = Smooth | Dry | Bristle | Impact


def viscous(c: float) -> Smooth:
    return Smooth(lambda q, v, t: c * v)


def drag(c: float) -> Smooth:
    return Smooth(lambda q, v, t: c * v * abs(v))


def bias(force: float) -> Smooth:
    """Pushes forward."""
    return Smooth(lambda q, v, t: -force)


def weight(a: float, b: float) -> Smooth:
    return Smooth(lambda q, v, t: a * sin(q) + b * cos(q))


def ripple(amplitude: float, order: float, phase: float) -> Smooth:
    return Smooth(lambda q, v, t: amplitude * sin(order * q + phase))


def elastic_stop(limit: float, stiffness: float, damping: float) -> Smooth:
    """A buffer: never pulls."""
    return Smooth(lambda q, v, t: max(stiffness * (q - limit) + damping * v, 0.0) if q > limit else 0.0)


def cubic(k3: float) -> Smooth:
    return Smooth(lambda q, v, t: k3 * q**3)


def dead_band(stiffness: float, half: float) -> Smooth:
    """What a gap takes away from a spring of that stiffness."""
    return Smooth(lambda q, v, t: -stiffness * min(max(q, -half), half))


def slack_spring(stiffness: float, half: float) -> Smooth:
    """A cable or a cover that pulls once the slack is gone."""
    return Smooth(lambda q, v, t: stiffness * (q - min(max(q, -half), half)))


def one_way_damper(c: float) -> Smooth:
    """Damps in the positive direction only."""
    return Smooth(lambda q, v, t: c * max(v, 0.0))


def leak(rate: float, reference: float) -> Smooth:
    return Smooth(lambda q, v, t: rate * (q - reference))


def overflow(rate: float, threshold: float) -> Smooth:
    return Smooth(lambda q, v, t: rate * max(q - threshold, 0.0))


def orifice(rate: float) -> Smooth:
    """A leak with the square root of the level."""
    return Smooth(lambda q, v, t: rate * copysign(sqrt(abs(q)), q))


def radiation(rate: float, room: float) -> Smooth:
    """To a room, both in degrees Celsius, with the fourth power of the absolute temperature."""
    return Smooth(lambda q, v, t: rate * ((q + 273.15) ** 4 - (room + 273.15) ** 4))


def coulomb(level: float) -> Dry:
    return Dry(lambda q, v, t: level)


def stribeck(level: float, more: float, speed: float) -> Dry:
    return Dry(lambda q, v, t: level + more * exp(-((v / speed) ** 2)))


def uneven(level: float, more: float) -> Dry:
    """Another level in either direction."""
    return Dry(lambda q, v, t: level + (more if v > 0 else -more))


def lugre(level: float, more: float, speed: float, seat: float) -> Bristle:
    """Bristles that break at a deflection of `seat`."""
    stiffness = level / seat

    def bent(z: float, v: float) -> float:
        return v - stiffness * abs(v) / (level + more * exp(-((v / speed) ** 2))) * z

    return Bristle(bent, lambda z, v: stiffness * z)


def bouc_wen(force: float, yielding: float) -> Bristle:
    """A loop that saturates at `force` once the deflection has turned by `yielding`."""
    return Bristle(lambda z, v: (v - abs(v) * z) / yielding, lambda z, v: force * z)
