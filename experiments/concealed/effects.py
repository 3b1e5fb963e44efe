"""An effect of a catalogue: which law, how strong, and which answers are right, near, or at the right place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from experiments.concealed.laws import Law

Pair = tuple[str, str]
Switches = dict[str, float]
STRENGTHS = {"weak": 0.35, "moderate": 1.0, "dominant": 2.5}


@dataclass(frozen=True)
class Surroundings:
    """What a draw may depend on: the true parameters, and the positions (samples, 4) and the largest torque of the first experiment,
    as the machine passes them without effect."""

    truth: Mapping[str, float]
    position: NDArray[np.float64]
    peak: float = np.nan


Draw = Callable[[Generator, float, Surroundings], Switches]


@dataclass(frozen=True)
class Effect:
    """One entry of the catalogue. `family`: effects of one family are not concealed together."""

    name: str
    law: type[Law]
    port: str
    family: str
    draw: Draw
    accept: tuple[Pair, ...]
    near: tuple[Pair, ...] = ()
    ports: tuple[str, ...] = ()
    outside: bool = False
    alone: tuple[Pair, ...] = ()
    """Further answers that are right as long as nothing else is concealed, and near otherwise."""
    sharp: bool = False
    """Physics with an edge, or richer than the library's law, in place of the law that the standard set has; for the proof alone."""

    @property
    def own(self) -> Pair:
        """Where it acts and the library's name for it there, `unknown` where it has none; the other right answers are look-alikes."""
        return next((pair for pair in self.accept if pair[0] == self.port), self.accept[0])


def sign(rng: Generator) -> float:
    """-1 or 1."""
    return float(rng.choice([-1.0, 1.0]))


def phase(rng: Generator) -> float:
    """0 to 2 pi."""
    return float(rng.uniform(0.0, 2.0 * np.pi))


def between(position: NDArray[np.float64], share: float) -> float:
    """The place at a share of the way from the lowest to the highest position."""
    low, high = float(position.min()), float(position.max())
    return low + share * (high - low)
