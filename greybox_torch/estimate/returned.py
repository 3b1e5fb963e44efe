"""Parameters that a descent sent orders of magnitude away, though the records do not determine them, returned."""

from __future__ import annotations

import numpy as np

from greybox_torch.estimate.free_run import FreeRun

FAR = 3.0
"""Decades from what is expected of it from which a parameter's value is looked at."""

SEEN = 0.01
"""Change of the log-likelihood that could be seen."""

ROUNDS = 3
"""How often all of them are gone through: one may only move once another has."""

HALVINGS = 8
"""Of the way in decades between what is expected and where the descent went."""


def returned(run: FreeRun, point: np.ndarray) -> np.ndarray:
    """The unknowns (d,) with parameters that are far from what is expected of them as near to it as the records allow.

    A level that nothing depends on any more goes anywhere. Seen: dry friction of an arm whose sharpness went to 1e-91 s/rad, and its level
    to 1e82 N m.

    Args:
        point: the unknowns at an optimum of ``run``.
    """
    expected = run.problem.expected[run.problem.free]
    if not len(_far(point[: run.n_parameters], expected)):
        return point  # as nearly always: no pass over whole records is needed to say so
    here = run.quadratic(point)
    if here is None:
        return point
    most = here.cost * (1.0 + 2.0 * SEEN / max(run.problem.samples, 1))
    for _ in range(ROUNDS):
        before = point
        for i in _far(point[: run.n_parameters], expected):
            point = _nearer(run, point, int(i), float(expected[i]), most)
        if np.array_equal(point, before):
            break
    return point


def _far(values: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Which of the values are many decades from those expected, the farthest first."""
    with np.errstate(divide="ignore", invalid="ignore"):
        decades = np.abs(np.log10(values / expected))
    decades = np.where(np.isfinite(decades), decades, 0.0)
    return np.argsort(-decades)[: int((decades > FAR).sum())]


def _nearer(run: FreeRun, point: np.ndarray, index: int, expected: float, most: float) -> np.ndarray:
    """``point`` with one unknown as near to ``expected`` as a cost of ``most`` allows, by halves of the decades between."""

    def at(part: float) -> np.ndarray:
        moved = point.copy()
        moved[index] = expected * (point[index] / expected) ** part
        return moved

    def allowed(part: float) -> bool:
        there = run.quadratic(at(part)) if run.admissible(at(part)) else None
        return there is not None and there.cost <= most

    if allowed(0.0):
        return at(0.0)
    not_yet, part = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (not_yet + part)
        not_yet, part = (not_yet, middle) if allowed(middle) else (middle, part)
    return at(part) if part < 1.0 else point
