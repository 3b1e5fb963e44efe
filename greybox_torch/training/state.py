"""Everything that a training needs to go on where it was."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass
class Epoch:
    """One pass over the windows of one length: mean loss of the batches and held-out loss, both relative to the physics, fit in % on
    the held-out windows, learning rate.
    """

    stage: int
    epoch: int
    loss: float
    held_out: float
    fit: float
    learning_rate: float


@dataclass
class TrainingState:
    """Where a training stands, at the end of an epoch.

    ``stage`` and ``epoch`` count window lengths and passes over the present one; ``z`` (d,) the unknowns, ``best`` (d,) those of the
    lowest held-out loss ``best_loss`` at this length, ``waited`` epochs ago; ``first`` and ``second`` (d,) the moments of Adam after
    ``steps`` steps; ``starts`` (W, n_x) of the windows; ``caution`` a factor on the learning rate that halves where a step diverges;
    ``generator`` the state of the random generator.
    """

    z: np.ndarray
    generator: dict[str, Any]
    stage: int = 0
    epoch: int = 0
    best: np.ndarray = field(default_factory=lambda: np.zeros(0))
    best_loss: float = float("inf")
    waited: int = 0
    first: np.ndarray = field(default_factory=lambda: np.zeros(0))
    second: np.ndarray = field(default_factory=lambda: np.zeros(0))
    steps: int = 0
    starts: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    caution: float = 1.0
    history: list[Epoch] = field(default_factory=list)

    @staticmethod
    def new(z: np.ndarray, seed: int) -> TrainingState:
        return TrainingState(z, np.random.default_rng([seed, 2]).bit_generator.state)  # type: ignore[arg-type]
