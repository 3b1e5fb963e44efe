"""A straight line tried against an unknown curve, on the whole estimation records and with all else estimated anew.

The heights of a curve are those that windows ask for, one by one, and of bumps that were left out zero: a law that is a straight line
comes out as one with steps. Where a line leaves hardly more error, it is what one would write into the model's class.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from greybox_torch.diagnosis.describe.law_over_data import SUM_OF_BUMPS
from greybox_torch.diagnosis.describe.signal_names import signal_name
from greybox_torch.diagnosis.describe.straight_line import STRAIGHT, as_equation
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.beside_curves import whole, with_whole_curves
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.steps_of_whole_records import in_steps_for_whole_records
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Quadratic, Settings, minimise
from greybox_torch.in_unit import in_unit
from greybox_torch.linear_algebra import least_squares
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, Body, Coupling
from greybox_torch.model.ports import Port
from greybox_torch.model.signals_elsewhere import ABOVE
from greybox_torch.name_lists import listed

HARDLY_MORE = 0.05
"""Share by which a line may leave more of the squared error than the curve as the model has it, to be told in its place."""

FEW = Settings(iterations=10, tolerance=1e-4)
"""Limits of the descent: what a line comes to is known to three digits after a few steps."""

MOVED = 0.1
"""Part by which a parameter of the model is another beside the line than beside the curve, from where on that is told."""

CLEARLY_BENT = 10.0 * STRAIGHT
"""Share of what the best curve removes beside a level one that a line lacks, by the quadratic model of the error, from where on none is
tried.
"""

INDEPENDENT = 1e-10
"""Directions in which that model has less curvature than this share of the largest are not determined."""


@dataclass(frozen=True)
class Line:
    """What was tried: its ``equation``, and what is to be known of it, a clause."""

    equation: str
    told: str


def line_tried(study: Study, fitted: Hypothesis, final: Final, attachment: Attachment, site: Port) -> Line | None:
    """The straight line that leaves hardly more error than the curve of ``attachment``; None where none does, and where whole records
    were not fitted, or not for the least squared error, by which a line is compared with the curve.

    A line through zero is tried first: a constant may be what a parameter of the model does.

    Args:
        final: with the effect, at the values that the verdict gives.
    """
    mechanism, at = whole(attachment).mechanism, final.problem
    if type(mechanism) is not Unknown or mechanism.closed or mechanism.part or mechanism.by_rate:
        return None
    names = signal_name(study.problem.model, site, mechanism.signal), _factor(study, site, mechanism.factor)
    if not isinstance(site, Body | Coupling | Balance) or names[1] is None or not names[0].isidentifier():
        return None
    if final.uncertainty is None or final.of_windows or final.weighed or mechanism.kinematic:
        return None
    study.working_on(f"trying a straight line at {attachment.port}")
    around, units = study.surroundings[attachment.port], {p.name: p.unit for p in fitted.model.declared_parameters}
    problem, simulator, _ = with_whole_curves(in_steps_for_whole_records(fitted, study.settings), at)
    run = FreeRun(problem, simulator)
    z, free = run.start, list(problem.free_names)
    places = [f"{attachment.prefix}.w_{k}" for k in mechanism.bumps]
    if not set(places) <= set(free):
        return None
    here = run.quadratic(z)
    columns, centres = [free.index(name) for name in places], np.array(mechanism.centres(around))
    shapes = [np.stack(shape, axis=1) / SUM_OF_BUMPS for shape in ([centres], [np.ones_like(centres), centres])]
    if here is None or _clearly_bent(here, z, columns, shapes[-1]):
        return None
    ends = cache(partial(_best_and_level, run, z, columns))
    for shape in shapes:
        found = _along(run, z, columns, shape)
        if found is not None and found[1] <= (1.0 + HARDLY_MORE) * here.cost and _straight(found[1], *ends()):
            point, cost, amounts = found
            own = {n: (at.values_by_name[n], float(v)) for n, v in zip(free, point, strict=False) if "." not in n}
            at_zero = 0.0 if len(amounts) == 1 else float(amounts[0])
            equation = as_equation(attachment.port, float(amounts[-1]), at_zero, names[0], names[1])
            return Line(equation, _told(cost / here.cost - 1.0, own, units))
    return None


def _best_and_level(run: FreeRun, z: np.ndarray, columns: Sequence[int]) -> tuple[float | None, float | None]:
    """The costs of the best curve of all its bumps and of one that is level; None for one that cannot be simulated."""
    shapes = (np.eye(len(columns)), np.ones((len(columns), 1)))
    best, level = (_along(run, z, columns, shape) for shape in shapes)
    return None if best is None else best[1], None if level is None else level[1]


def _straight(cost: float, best: float | None, level: float | None) -> bool:
    """Whether a line of such ``cost`` lacks hardly any of what the best curve removes beside one that is level."""
    return best is not None and (level is None or cost - best <= STRAIGHT * (level - best))


def _clearly_bent(here: Quadratic, z: np.ndarray, columns: Sequence[int], line: np.ndarray) -> bool:
    """Whether no ``line`` (k, 2) would be :func:`_straight`, by far, as the error is near the unknowns ``z``: without any simulation."""
    shapes = (np.eye(len(columns)), line, np.ones((len(columns), 1)))
    best, straight, level = (_least(here, z, _within(z, columns, shape)) for shape in shapes)
    return straight - best > CLEARLY_BENT * (level - best)


def _factor(study: Study, site: Port, factor: str) -> str | None:
    """What multiplies a curve as one would write it, a level less an input as a difference; None where the class has no name for it."""
    name = signal_name(study.problem.model, site, factor) if factor else ""
    return name if not name or name.isidentifier() or factor.startswith(ABOVE) else None


def _along(
    run: FreeRun, z: np.ndarray, columns: Sequence[int], shape: np.ndarray
) -> tuple[np.ndarray, float, np.ndarray] | None:
    """The optimum whose heights, at ``columns`` of the unknowns ``z`` (d,), are a sum of those of ``shape`` (k, m): the unknowns, the cost
    and the amounts (m,); None where it cannot be simulated.
    """
    within = _within(z, columns, shape)
    others = np.setdiff1d(np.arange(len(z)), columns)
    begun = np.concatenate([z[others], least_squares(shape, z[list(columns)])])

    def evaluated(y: np.ndarray) -> Quadratic[None] | None:
        one = run.quadratic(within @ y)
        return one and Quadratic(one.cost, within.T @ one.gradient, within.T @ one.hessian @ within, None)

    low, high = run.bounds
    open_ended = np.full(shape.shape[1], np.inf)
    ends = np.concatenate([low[others], -open_ended]), np.concatenate([high[others], open_ended])
    best = minimise(evaluated, begun, *ends, settings=FEW, admissible=lambda y: run.admissible(within @ y))
    if best is None:
        return None
    return within @ best.point, best.model.cost, best.point[len(others) :]


def _within(z: np.ndarray, columns: Sequence[int], shape: np.ndarray) -> np.ndarray:
    """What the unknowns ``z`` (d,) are by those beside ``columns`` and the amounts of ``shape`` (k, m): (d, d - k + m)."""
    others = np.setdiff1d(np.arange(len(z)), columns)
    within = np.zeros((len(z), len(others) + shape.shape[1]))
    within[others, np.arange(len(others))] = 1.0
    within[np.ix_(columns, range(len(others), within.shape[1]))] = shape
    return within


def _least(here: Quadratic, z: np.ndarray, within: np.ndarray) -> float:
    """The least cost that the quadratic model at ``z`` (d,) has among unknowns that are a product of ``within`` (d, e)."""
    curvature, slope = within.T @ here.hessian @ within, within.T @ (here.gradient - here.hessian @ z)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(curvature), 1e-300))
    best = scale * least_squares(scale[:, None] * curvature * scale, -scale * slope, rcond=INDEPENDENT)
    step = within @ best - z
    return float(here.cost + here.gradient @ step + 0.5 * step @ here.hessian @ step)


def _told(more: float, own: dict[str, tuple[float, float]], units: dict[str, str]) -> str:
    moved = [
        f"{in_unit(f'{name} = {digits(now, 3)}', units.get(name, ''))}"
        for name, (before, now) in own.items()
        if abs(now - before) > MOVED * max(abs(now), abs(before))
    ]
    beside = f", with {listed(moved)} beside it" if moved else ""
    share = f"{digits(100 * more, 2)} % more" if more >= 0.001 else "no more"
    return (
        f"a straight line in the place of the curve{beside}, leaves {share} squared error in the estimation experiments than the curve as "
        "the model has it"
    )
