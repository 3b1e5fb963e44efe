"""What is drawn for a fleet: which machine has which effect, how large on which date, and when it changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import date, timedelta
from typing import Any

import numpy as np
from numpy.random import Generator, SeedSequence

FIRST_DAY = date(2026, 1, 1)
YEAR = 365
SCATTER = 0.04
"""Relative deviation of an effect, and of the viscous friction, from recording to recording: temperature, load, lubrication."""


@dataclass(frozen=True)
class Kind:
    """An effect: the ``law`` of the plant, its switch, the usual ``size`` of it, and the names it rightly has in a verdict."""

    law: str
    switch: str
    size: float
    accept: tuple[tuple[str, str], ...]


KINDS: Mapping[str, Kind] = {
    "coulomb": Kind("DryCoulomb", "level", 0.08, (("rotor", "coulomb_friction"), ("rotor", "stribeck_friction"))),
    "drag": Kind("QuadraticDrag", "c", 3e-3, (("rotor", "quadratic_drag"),)),
    "dead zone": Kind("ActuatorDeadzone", "half_width", 0.1, (("actuator", "actuator_deadzone"),)),
}


@dataclass(frozen=True)
class Planned:
    """A machine. By recording: ``dates`` (ISO 8601), ``sizes`` of its effect (zero where it is not there) and ``damping`` in N m s/rad.

    ``changed`` is the first recording after its change, None where it has none.
    """

    name: str
    effect: str
    inertia: float
    dates: tuple[str, ...]
    sizes: tuple[float, ...]
    damping: tuple[float, ...]
    changed: int | None = None

    def as_json(self) -> dict[str, Any]:
        return asdict(self)


def draw_fleet(machines: int, recordings: int, seed: int) -> list[Planned]:
    """A quarter of the machines has no effect; half of the others changes about the middle of the year.

    The effect appears there, or grows by a half or more.
    """
    order = np.random.default_rng(SeedSequence([seed, 0])).permutation(machines)
    return [_machine(number, int(order[number]), recordings, seed) for number in range(machines)]


def _machine(number: int, place: int, recordings: int, seed: int) -> Planned:
    rng = np.random.default_rng(SeedSequence([seed, 1, number]))
    inertia = float(f"{0.02 * np.exp(rng.uniform(-0.2, 0.2)):.4g}")
    damping = 0.05 * np.exp(rng.uniform(-0.2, 0.2)) * _scatter(rng, recordings)
    dates = _dates(rng, recordings)
    if place % 4 == 0:
        return Planned(f"m{number:03d}", "", inertia, dates, (0.0,) * recordings, _rounded(damping))
    effect = list(KINDS)[place % 4 - 1]
    sizes = KINDS[effect].size * np.exp(rng.normal(0.0, 0.15)) * _scatter(rng, recordings)
    changed = None
    if place // 4 % 2 == 0:
        changed = int(rng.integers(recordings // 2 - 1, recordings // 2 + 2))
        sizes[:changed] *= 0.0 if rng.random() < 0.5 else 1.0 / rng.uniform(1.5, 2.5)
    return Planned(f"m{number:03d}", effect, inertia, dates, _rounded(sizes), _rounded(damping), changed)


def _scatter(rng: Generator, count: int) -> np.ndarray:
    return np.exp(rng.normal(0.0, SCATTER, count))


def _rounded(values: np.ndarray) -> tuple[float, ...]:
    return tuple(float(f"{value:.6g}") for value in values)


def _dates(rng: Generator, count: int) -> tuple[str, ...]:
    """Spread over the year, each somewhere in its share of it."""
    share = YEAR / count
    return tuple(
        (FIRST_DAY + timedelta(days=int((k + rng.uniform(0.1, 0.9)) * share))).isoformat() for k in range(count)
    )
