"""Levenberg-Marquardt on normal equations, with bounds and with trial steps that may fail."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from greybox_torch.estimate.bounded_step import bounded_step
from greybox_torch.estimate.termination import Termination
from greybox_torch.linear_algebra import lengths

Extra = TypeVar("Extra")


@dataclass(frozen=True)
class Quadratic(Generic[Extra]):
    """The cost ½‖r‖² at a point, its gradient (d,) and its Gauss-Newton Hessian JᵀJ (d, d), and whatever the caller wants back."""

    cost: float
    gradient: np.ndarray
    hessian: np.ndarray
    extra: Extra


@dataclass(frozen=True)
class Settings:
    """Limits of the iteration. ``tolerance`` is the relative change of the cost that counts as none."""

    iterations: int = 200
    tolerance: float = 1e-10
    damping: float = 1e-3
    trials: int = 14


DEFAULT = Settings()
"""To the optimum."""

ROUGH = Settings(iterations=25, tolerance=1e-4)
"""To its neighbourhood."""


@dataclass(frozen=True)
class Optimum(Generic[Extra]):
    """Where the iteration ended."""

    point: np.ndarray
    model: Quadratic[Extra]
    iterations: int
    evaluations: int
    termination: Termination


@dataclass(frozen=True)
class Allowed:
    """Asks whether the constraints beyond the bounds hold at ``point`` (d,)."""

    point: np.ndarray


@dataclass(frozen=True)
class Evaluated:
    """Asks for cost, gradient and Hessian at ``point`` (d,); None where the simulation fails there."""

    point: np.ndarray


Descending = Generator[Allowed | Evaluated, Any, Optimum[Extra] | None]
"""A descent that says what it has to know next, is sent that, and returns where it ended: so that many can be answered together."""


def minimise(
    evaluate: Callable[[np.ndarray], Quadratic[Extra] | None],
    start: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    *,
    settings: Settings = DEFAULT,
    admissible: Callable[[np.ndarray], bool] = lambda point: True,
    on_iteration: Callable[[int, float, float], None] | None = None,
) -> Optimum[Extra] | None:
    """Minimise a sum of squares from ``start`` (d,) within [lower, upper].

    Args:
        evaluate: cost, gradient and Hessian at a point, or None where the simulation fails there (a rejected step).
        admissible: constraints beyond the bounds; steps are shortened until they hold.
        on_iteration: called with iteration, cost and damping after every accepted step.

    Returns:
        The optimum, or None where ``evaluate`` fails at the start already.
    """
    return answered(descending(start, lower, upper, settings=settings, on_iteration=on_iteration), evaluate, admissible)


def answered(
    descent: Descending[Extra],
    evaluate: Callable[[np.ndarray], Quadratic[Extra] | None],
    admissible: Callable[[np.ndarray], bool],
) -> Optimum[Extra] | None:
    """Where a descent ends, question by question."""
    answer: Any = None
    while True:
        try:
            asked = descent.send(answer)
        except StopIteration as end:
            return end.value
        answer = evaluate(asked.point) if isinstance(asked, Evaluated) else admissible(asked.point)


def descending(
    start: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    *,
    settings: Settings = DEFAULT,
    on_iteration: Callable[[int, float, float], None] | None = None,
) -> Descending[Any]:
    """What :func:`minimise` does, as questions.

    Source: D. W. Marquardt (1963); damping after H. B. Nielsen, "Damping parameter in Marquardt's method", 1999; bounds by
    :func:`bounded_step`.
    """
    point = np.clip(start, lower, upper)
    here = yield Evaluated(point)
    if here is None:
        return None
    if not point.size:
        return Optimum(point, here, 0, 1, Termination.nothing_free)
    evaluations, growth, damping = 1, 2.0, settings.damping
    diagonal = _diagonal(here.hessian, None)
    for iteration in range(1, settings.iterations + 1):
        diagonal = _diagonal(here.hessian, diagonal)
        moved = False
        for _ in range(settings.trials):
            step = _step(here, lengths(diagonal), damping, lower - point, upper - point)
            trial = yield from _shortened(point, step, lower, upper)
            taken = trial - point
            predicted = -(here.gradient @ taken) - 0.5 * taken @ here.hessian @ taken
            if not taken.any() or 0.0 <= predicted <= 1e-2 * settings.tolerance * here.cost:
                return Optimum(point, here, iteration, evaluations, Termination.small_step)
            there = (yield Evaluated(trial)) if predicted > 0 else None
            evaluations += 1
            gain = -1.0 if there is None else _part_of(float(here.cost - there.cost), float(predicted))
            if there is not None and gain > 1e-4:
                change = (here.cost - there.cost) / here.cost
                point, here, moved = trial, there, True
                damping *= max(0.1, 1.0 - (2.0 * gain - 1.0) ** 3) if gain < 1.0 else 0.1
                growth = 2.0
                break
            damping, growth = damping * growth, growth * 2.0
        if on_iteration is not None:
            on_iteration(iteration, here.cost, damping)
        if not moved:
            return Optimum(point, here, iteration, evaluations, Termination.stalled)
        if change < settings.tolerance:
            return Optimum(point, here, iteration, evaluations, Termination.converged)
    return Optimum(point, here, settings.iterations, evaluations, Termination.iteration_limit)


def _part_of(gained: float, predicted: float) -> float:
    """What was gained as a part of what was predicted; of next to nothing that was predicted, more than any number can say."""
    with np.errstate(over="ignore"):
        return float(np.divide(gained, predicted))


def _diagonal(hessian: np.ndarray, before: np.ndarray | None) -> np.ndarray:
    """Scales of the unknowns: the largest curvature seen so far, as MINPACK does."""
    now = np.diag(hessian)
    return now if before is None else np.maximum(now, before)


def _step(here: Quadratic, scale: np.ndarray, damping: float, lowest: np.ndarray, highest: np.ndarray) -> np.ndarray:
    """The damped step between ``lowest`` and ``highest`` (d,), the unknowns in units of ``scale`` (d,).

    An unknown that moves nothing stays where it is: rounding errors, in units of its scale, would be a step without end.
    """
    matrix = here.hessian * scale[:, None] * scale[None, :]
    matrix[np.diag_indices_from(matrix)] += damping
    step = scale * bounded_step(matrix, -here.gradient * scale, lowest / scale, highest / scale)
    return np.where(np.diag(here.hessian) > 0.0, step, 0.0)


def _shortened(
    point: np.ndarray, step: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> Generator[Allowed, bool, np.ndarray]:
    """The projected step, halved until the joint constraints hold (not at all where they never do)."""
    for _ in range(30):
        trial = np.clip(point + step, lower, upper)
        if (yield Allowed(trial)):
            return trial
        step = 0.5 * step
    return point
