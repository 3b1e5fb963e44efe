"""The information matrix of a run at a point, and the directions in which it is flat."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.linear_algebra import eigenvalues, eigh

FLAT = {"double": 1e-11, "single": 1e-5}
"""Curvature, relative to the largest in unknowns of unit diagonal, that rounding alone accounts for."""

FLAT_BY_SAMPLES = 3e-14
"""The same of a matrix summed over samples in double precision. (Seen of what is flat: up to 5e-16. Of a motor that a last grain of force
moves out of one detent of its cogging or leaves in it, which outweighs all else that is known: 3e-13, right to half a percent.)"""

UNSEEN = {"double": 1e-16, "single": 1e-11}
"""Share of the outputs' energy, moved by a change of a parameter by its own size, that counts as none."""

EXPLODED = {"double": 1e16, "single": 1e10}
"""Times the outputs' energy, moved by a change of an unknown by its own size, from which derivatives are grown rounding errors."""

NEGLIGIBLE = 1e-5
"""Part of a direction's largest contribution to the outputs below which an unknown takes no part in it."""

HOLDS = {"double": 1e-6, "single": 1e-3}
"""Curvature of a direction, relative to its largest part's, below which it is flat at a point nearby too."""


@dataclass(frozen=True)
class Information:
    """The Gauss-Newton Hessian (d, d) of a run at ``z`` (d,), summed over windows or ``by_samples``."""

    run: FreeRun
    z: np.ndarray
    hessian: np.ndarray
    by_samples: bool = False

    def closer(self) -> Information:
        """The same summed over samples, where that tells more of what is flat; itself elsewhere."""
        hessian = self.run.by_samples(self.z) if self.precision == "double" else None
        return self if hessian is None else replace(self, hessian=hessian, by_samples=True)

    @property
    def rounding(self) -> float:
        """Curvature that rounding alone accounts for, see :data:`FLAT`."""
        return FLAT_BY_SAMPLES if self.by_samples else FLAT[self.precision]

    @property
    def precision(self) -> str:
        """Of the simulation: "double" or "single"."""
        return self.run.simulator.options.precision

    @property
    def scale(self) -> np.ndarray:
        """Unknowns per unit of contribution to the outputs (d,), zero where there is none."""
        diagonal = np.diag(self.hessian)
        return np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)

    def exploded(self) -> float:
        """The most by which an unknown, changed by its own size, moves the outputs, relative to them; zero where that is possible."""
        moved = self.z**2 * np.diag(self.hessian)
        share = float(moved.max(initial=0.0)) / max(energy_of(self.run), 1e-300)
        return float(np.sqrt(share)) if share > EXPLODED[self.precision] else 0.0

    def unmoved(self) -> list[int]:
        """The unknowns that, changed by their own size, do not change the outputs."""
        diagonal, own = np.diag(self.hessian), np.abs(self.z)
        energy = max(energy_of(self.run), 1e-300)
        parameter = np.arange(len(self.z)) < self.run.n_parameters
        moved = own * np.sqrt(np.maximum(diagonal, 0.0))  # not squared: what ran away would overflow
        unseen = parameter & (own > 0) & (moved < np.sqrt(UNSEEN[self.precision] * energy))
        return np.flatnonzero(unseen | (diagonal <= 0)).tolist()

    def flat_directions(self) -> list[np.ndarray]:
        """Changes (d,) of two unknowns or more that together do not change the outputs, each of as few as can be."""
        kept = np.setdiff1d(np.arange(len(self.z)), self.unmoved())
        scale = self.scale[kept]
        values, vectors = eigh(self.hessian[np.ix_(kept, kept)] * np.outer(scale, scale))
        null = vectors[:, values < self.rounding * values.max(initial=0.0)].T
        found = []
        for row in echelon(null):
            step = np.zeros(len(self.z))
            step[kept] = row * scale
            found.append(step)
        return found

    def is_flat(self, step: np.ndarray) -> bool:
        """Whether the change ``step`` (d,) leaves the outputs as they are."""
        parts = np.abs(step) * np.sqrt(np.diag(self.hessian))
        return float(step @ self.hessian @ step) <= HOLDS[self.precision] * float(parts.max(initial=0.0)) ** 2

    def is_flat_within(self, members: np.ndarray) -> bool:
        """Whether some change of the ``members`` alone leaves the outputs as they are."""
        scale = self.scale[members]
        values = eigenvalues(self.hessian[np.ix_(members, members)] * np.outer(scale, scale))
        return values[0] <= 10 * FLAT[self.precision] * values[-1]


def echelon(null: np.ndarray, negligible: float = NEGLIGIBLE) -> np.ndarray:
    """A sparse basis of the span of row vectors (m, d): their reduced echelon form under complete pivoting, small entries cleared."""
    rows = null.copy()
    for k in range(len(rows)):
        i, j = np.unravel_index(np.argmax(np.abs(rows[k:])), rows[k:].shape)
        rows[[k, k + i]] = rows[[k + i, k]]
        rows[k] /= rows[k, j]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, j], rows[k])
    largest = np.abs(rows).max(axis=1, initial=0.0, keepdims=True)
    return np.where(np.abs(rows) < negligible * largest, 0.0, rows)


def energy_of(run: FreeRun) -> float:
    """Sum of squares of the weighted outputs about their means."""
    y = run.problem.records.y * run.problem.weights[:, None]
    return float(np.nansum((y - np.nanmean(y, axis=1, keepdims=True)) ** 2))
