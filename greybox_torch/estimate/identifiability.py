"""Which parameters the data cannot determine, alone or together, before they are estimated and after.

At a point z the outputs change by J dz, so that what leaves JᵀJ dz = 0 cannot be seen. Directions in which that is so are looked for in
unknowns scaled to unit diagonal, and named parameter by parameter after a reduction to echelon form, which keeps apart what has nothing to
do with each other. Since a matrix at one point may be singular for no reason but the point (a shape has no effect while its amplitude is
zero), every such finding is looked at again at a point nearby: a direction that data can never show is flat almost everywhere.

Source: T. J. Rothenberg, "Identification in parametric models", Econometrica 39 (1971): rank of the information matrix at a regular point.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.identifiability_sentences import Direction, sentence
from greybox_torch.estimate.levenberg_marquardt import Quadratic

FLAT = {"double": 1e-11, "single": 1e-5}
"""Curvature, relative to the largest in unknowns of unit diagonal, that rounding alone accounts for."""

UNSEEN = {"double": 1e-16, "single": 1e-9}
"""Share of the outputs' energy, moved by a change of a parameter by its own size, that counts as none."""

NEGLIGIBLE = 1e-5
"""Part of a direction's largest contribution to the outputs below which an unknown takes no part in it."""

PROMINENT = 0.3
"""Part of a weak direction's largest relative change from which a parameter is named."""

HOLDS = {"double": 1e-6, "single": 1e-3}
"""Curvature of a direction, relative to its largest part's, below which it is flat at a point nearby too."""

NEARBY = 0.1
"""How far off, relative to their size, the unknowns are at the point nearby."""


@dataclass(frozen=True)
class Weakness:
    """What the data do not determine.

    ``kind`` is "unmoved" (nothing the parameter does shows in the outputs), "together" (only a combination shows), "start" (either of
    these, but only because of where the unknowns are) or "weak" (the standard deviation exceeds the value). ``parameters`` are those
    involved, start states among them as "motor_speed at the start of 'Steps'"; ``direction`` their changes that leave the outputs as they
    are: relative to their value where that is not zero, else in their unit, the largest being 1.
    """

    kind: str
    parameters: tuple[str, ...]
    direction: tuple[float, ...]
    sentence: str

    @property
    def undetermined(self) -> bool:
        """Whether no estimate of these parameters means anything, as against one that is merely uncertain."""
        return self.kind in ("unmoved", "together")


def identifiability(
    run: FreeRun, z: np.ndarray, here: Quadratic[None] | None = None, *, precision: str = "double"
) -> tuple[Weakness, ...]:
    """What the data do not determine of the unknowns ``z`` (d,) of ``run``; nothing where the simulation overflows there.

    Args:
        here: cost and Gauss-Newton Hessian at ``z``, computed where it is not given.
    """
    here = here or run.quadratic(z)
    if here is None or not run.n_parameters:
        return ()
    view = _View(run, z, here.hessian, precision)
    unmoved, flat = view.unmoved(), view.flat_directions()
    nearby = _nearby(view, here) if len(unmoved) or len(flat) else None
    found = [_unmoved(view, i, nearby) for i in unmoved if i < run.n_parameters]
    found += [_together(view, step, nearby) for step in flat]
    held = {*unmoved, *[int(np.argmax(np.abs(step) * np.sqrt(np.diag(here.hessian)))) for step in flat]}
    return (*found, *_weak(view, here, held))


@dataclass(frozen=True)
class _View:
    """The Gauss-Newton Hessian (d, d) of a run at ``z`` (d,)."""

    run: FreeRun
    z: np.ndarray
    hessian: np.ndarray
    precision: str

    @property
    def scale(self) -> np.ndarray:
        """Unknowns per unit of contribution to the outputs (d,), zero where there is none."""
        diagonal = np.diag(self.hessian)
        return np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)

    def unmoved(self) -> list[int]:
        """The unknowns that, changed by their own size, do not change the outputs."""
        diagonal, own = np.diag(self.hessian), np.abs(self.z)
        energy = max(_energy(self.run), 1e-300)
        parameter = np.arange(len(self.z)) < self.run.n_parameters
        unseen = parameter & (own > 0) & (own**2 * diagonal < UNSEEN[self.precision] * energy)
        return np.flatnonzero(unseen | (diagonal <= 0)).tolist()

    def flat_directions(self) -> list[np.ndarray]:
        """Changes (d,) of two unknowns or more that together do not change the outputs, each of as few as can be."""
        kept = np.setdiff1d(np.arange(len(self.z)), self.unmoved())
        scale = self.scale[kept]
        values, vectors = np.linalg.eigh(self.hessian[np.ix_(kept, kept)] * np.outer(scale, scale))
        null = vectors[:, values < FLAT[self.precision] * values.max(initial=0.0)].T
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
        values = np.linalg.eigvalsh(self.hessian[np.ix_(members, members)] * np.outer(scale, scale))
        return values[0] <= 10 * FLAT[self.precision] * values[-1]


def echelon(null: np.ndarray) -> np.ndarray:
    """The reduced echelon form of row vectors (m, d) under complete pivoting, small entries cleared: one basis of their span, sparse."""
    rows = null.copy()
    for k in range(len(rows)):
        i, j = np.unravel_index(np.argmax(np.abs(rows[k:])), rows[k:].shape)
        rows[[k, k + i]] = rows[[k + i, k]]
        rows[k] /= rows[k, j]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, j], rows[k])
    largest = np.abs(rows).max(axis=1, initial=0.0, keepdims=True)
    return np.where(np.abs(rows) < NEGLIGIBLE * largest, 0.0, rows)


def _nearby(view: _View, here: Quadratic[None]) -> _View | None:
    """The view from a point at which no unknown is zero, at a bound, or equal to another by chance; None where nothing simulates there."""
    run, z = view.run, view.z
    diagonal, (low, high) = np.diag(here.hessian), run.bounds
    typical = np.sqrt(
        2 * here.cost / np.where(diagonal > 0, diagonal, np.inf)
    )  # moves the outputs as much as they are off
    finite = np.isfinite(high - low)
    typical = np.where(typical > 0, typical, np.where(finite, np.where(finite, high - low, 0.0), 1.0))
    away = NEARBY * np.random.default_rng(0).uniform(0.5, 1.0, len(z)) * np.where(z != 0, np.abs(z), typical)
    away = np.where(z + away > high, -away, away)
    for _ in range(6):
        point = np.clip(z + away, low, high)
        there = run.quadratic(point) if run.admissible(point) else None
        if there is not None:
            return replace(view, z=point, hessian=there.hessian)
        away = 0.5 * away
    return None


def _unmoved(view: _View, index: int, nearby: _View | None) -> Weakness:
    name = _names(view.run)[index]
    kind = "unmoved" if nearby is None or index in nearby.unmoved() else "start"
    step = Direction((name,), (1.0,), (view.z[index] != 0,))
    return Weakness(kind, (name,), step.changes, sentence(kind, step, zeros=_zeros(view)))


def _together(view: _View, step: np.ndarray, nearby: _View | None) -> Weakness:
    members = np.flatnonzero(step)
    nonzero = (view.z[members] != 0) & (members < view.run.n_parameters)
    changes = step[members] / np.where(nonzero, view.z[members], 1.0)
    changes /= changes[np.argmax(np.abs(changes))]
    names = tuple(_names(view.run)[i] for i in members)
    direction = Direction(names, tuple(map(float, changes)), tuple(map(bool, nonzero)))
    law, kind = "local", "together"
    if nearby is not None:
        scaled = np.zeros(len(step))
        scaled[members] = changes * nearby.z[members]
        if not nearby.is_flat_within(members):
            kind = "start"
        elif nonzero.all() and nearby.is_flat(scaled):
            law = "factor"
        elif nearby.is_flat(step):
            law = "shift"
    absolute = step[members] / step[members[np.argmax(np.abs(step[members]))]]
    direction = replace(direction, law=law, absolute=tuple(map(float, absolute)))
    return Weakness(kind, names, direction.changes, sentence(kind, direction, zeros=_zeros(view)))


def _weak(view: _View, here: Quadratic[None], held: set[int]) -> Iterator[Weakness]:
    """Directions in which the parameters' relative standard deviation exceeds one, the ``held`` unknowns fixed.

    The errors' variance is what a linear model leaves after the best step from here, so that poor start values are not taken for noise.
    """
    kept = np.setdiff1d(np.arange(len(view.z)), sorted(held))
    scale = view.scale[kept]
    inverse = np.linalg.pinv(
        view.hessian[np.ix_(kept, kept)] * np.outer(scale, scale), rcond=FLAT[view.precision], hermitian=True
    )
    inverse *= np.outer(scale, scale)
    gradient = here.gradient[kept]
    left = 2 * here.cost - float(gradient @ inverse @ gradient)
    variance = max(left, 0.0) / max(_samples(view.run) - len(kept), 1)
    own = np.flatnonzero((kept < view.run.n_parameters) & (view.z[kept] != 0))
    value = view.z[kept[own]]
    spread, vectors = np.linalg.eigh(variance * inverse[np.ix_(own, own)] / np.outer(value, value))
    names = _names(view.run)
    for k in np.argsort(-spread):
        if spread[k] <= 1.0:
            return
        vector = vectors[:, k] / vectors[np.argmax(np.abs(vectors[:, k])), k]
        named = np.flatnonzero(np.abs(vector) >= PROMINENT)
        members = tuple(names[kept[own[i]]] for i in named)
        step = Direction(members, tuple(map(float, vector[named])), (True,) * len(named))
        yield Weakness("weak", members, step.changes, sentence("weak", step, deviation=float(np.sqrt(spread[k]))))


def _names(run: FreeRun) -> list[str]:
    problem = run.problem
    states = [problem.model.states[i].name for i in problem.free_states]
    return [*problem.free_names, *[f"{s} at the start of '{e}'" for e in problem.tape.names for s in states]]


def _zeros(view: _View) -> tuple[str, ...]:
    """The free parameters that are zero, which is where others lose their effect."""
    return tuple(n for n, v in zip(view.run.problem.free_names, view.z, strict=False) if v == 0)


def _energy(run: FreeRun) -> float:
    """Sum of squares of the weighted outputs about their means."""
    y = run.problem.tape.y * run.problem.weights[:, None]
    return float(np.nansum((y - np.nanmean(y, axis=1, keepdims=True)) ** 2))


def _samples(run: FreeRun) -> int:
    return int((~np.isnan(run.problem.tape.y)).sum())
