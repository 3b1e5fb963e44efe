"""Levenberg-Marquardt on the scale of logarithms, for unknowns that cannot be negative.

Sizes that act as a product, a friction level and its sharpness, form valleys that are bent for the sizes and straight for their
logarithms; along a bent valley a descent creeps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from greybox_torch.estimate.levenberg_marquardt import (
    Descending,
    Optimum,
    Quadratic,
    Settings,
    descending,
)


@dataclass(frozen=True)
class Scale:
    """Which unknowns (d,) are seen as logarithms: those that are positive and cannot be negative."""

    logarithmic: np.ndarray

    @staticmethod
    def of(point: np.ndarray, lower: np.ndarray) -> Scale:
        """As a start ``point`` (d,) and the lower bounds (d,) have it."""
        return Scale((lower >= 0.0) & (point > 0.0))

    def seen(self, point: np.ndarray) -> np.ndarray:
        """Unknowns as logarithms where they are positive; a bound at zero lies at −∞."""
        with np.errstate(divide="ignore"):
            return np.where(self.logarithmic, np.log(np.where(self.logarithmic, point, 1.0)), point)

    def meant(self, seen: np.ndarray) -> np.ndarray:
        """The unknowns (d,) back from what is seen of them."""
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, np.minimum(seen, LARGEST), 0.0)), seen)

    def slopes(self, point: np.ndarray) -> np.ndarray:
        """Derivative (d,) of the unknowns by what is seen of them."""
        return np.where(self.logarithmic, point, 1.0)


def descending_on_logarithms(
    start: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    *,
    settings: Settings,
    on_iteration: Callable[[int, float, float], None] | None = None,
) -> Descending[None]:
    """As :func:`descending`, with positive unknowns varied by factors; it asks about the unknowns themselves. A bound at zero is approached
    and not reached.
    """
    scale = Scale.of(start, lower)
    descent = descending(
        scale.seen(start),
        scale.seen(np.where(scale.logarithmic, np.maximum(lower, SMALLEST), lower)),
        scale.seen(upper),
        settings=settings,
        on_iteration=on_iteration,
    )
    answer: Any = None
    while True:
        try:
            asked = descent.send(answer)
        except StopIteration as end:
            return None if end.value is None else _meant(scale, end.value)
        point = scale.meant(asked.point)
        answer = yield replace(asked, point=point)
        if isinstance(answer, Quadratic):
            slope = scale.slopes(point)
            hessian = answer.hessian * slope[:, None] * slope[None, :]
            answer = Quadratic(answer.cost, answer.gradient * slope, hessian, None)


def _meant(scale: Scale, found: Optimum[None]) -> Optimum[None]:
    """An optimum on the scale of logarithms as one of the unknowns themselves."""
    point = scale.meant(found.point)
    slope = scale.slopes(point)
    model = Quadratic(
        found.model.cost, found.model.gradient / slope, found.model.hessian / slope[:, None] / slope[None, :], None
    )
    return Optimum(point, model, found.iterations, found.evaluations, found.termination)


SMALLEST, LARGEST = 1e-30, 700.0
"""Stands for zero; the largest logarithm whose exponential is a number."""
