"""The profile likelihood of one parameter: how fast the cost rises when it is held elsewhere and all others make up for it.

Where the model is not linear in a parameter, its confidence interval is not the symmetric one of a standard deviation; the profile shows it
as it is, bounded on one side or open where the data set no limit.

Source: D. M. Bates and D. G. Watts, "Nonlinear Regression Analysis and Its Applications", 1988, ch. 6; for coloured residuals the rise is
divided as in J. T. Kent, "Robust properties of likelihood ratio tests", Biometrika 69 (1982).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from greybox_torch.errors import ArgumentError, did_you_mean
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Optimum, Settings, minimise
from greybox_torch.in_unit import in_unit
from greybox_torch.linear_algebra import least_squares
from greybox_torch.simulation.simulator import Simulator

LEVEL = 0.95
"""Confidence of the interval."""

THRESHOLD = 3.841
"""Rise that a χ² variable of one degree of freedom exceeds in 5 % of all cases."""

STEP = 0.4
"""First step, in standard deviations."""

POINTS = 40
"""Most values tried on either side."""

STEEP = 3.0
"""Rise, in thresholds, from which one step was too long to say where the threshold is passed."""

FAR = 100.0
"""Times the estimate's size, up to which an end of the interval is looked for; and how finely, in parts of that size."""

SETTINGS = Settings(iterations=30, tolerance=1e-8)


@dataclass(frozen=True)
class Profile:
    """The profile of the parameter ``name`` in ``unit``.

    ``values`` (G,) ascending, the ``estimate`` among them; ``rise`` (G,) what the sum of squares rises by above the optimum's, in error
    variances and divided by ``colour``, so that ``THRESHOLD`` is its 95 % level. ``colour`` is the ratio of the estimate's variance that
    allows for coloured residuals to the plain one, 1 for white ones. ``lower`` and ``upper`` end the 95 % interval, infinite where the
    rise did not reach that level; ``lower_bound`` and ``upper_bound`` say whether a bound of the parameter ended the search there.
    ``deviation`` is the standard deviation that allows for coloured residuals. Where the cost falls by that level on the way, the estimate
    is no optimum, and there is no interval around it: both ends are infinite.
    """

    name: str
    unit: str
    estimate: float
    deviation: float
    colour: float
    values: np.ndarray
    rise: np.ndarray
    lower: float
    upper: float
    lower_bound: bool
    upper_bound: bool

    @property
    def better(self) -> float | None:
        """The value of the lowest cost, where that lies below the estimate's by more than the level of an interval; else None."""
        return float(self.values[np.argmin(self.rise)]) if self.rise.min() < -THRESHOLD else None

    @property
    def sentence(self) -> str:
        """The interval in words."""
        if self.better is not None:
            there, here = (in_unit(f"{value:.5g}", self.unit) for value in (self.better, self.estimate))
            return (
                f"{self.name}: no interval: the estimate of {here} is no optimum, at {there} the cost is {-self.rise.min():.3g} error "
                "variances lower. The estimate is kept: fit again from there "
                f"({self.name} = {{ value = {self.better:.5g} }} in [model.parameters])"
            )
        low, high = (in_unit(f"{end:.5g}", self.unit) for end in (self.lower, self.upper))
        ends = [self.values[0], self.values[-1]]
        reached = [np.isfinite(self.lower), np.isfinite(self.upper)]
        within = f"within the {LEVEL:.0%} level".replace("%", " %")
        tried = [
            f"{in_unit(f'{end:.5g}', self.unit)}, {'its bound' if bound else 'as far as was tried'}"
            for bound, end in zip((self.lower_bound, self.upper_bound), ends, strict=True)
        ]
        if all(reached):
            text = f"{low} to {high}"
        elif reached[0]:
            text = f"from {low}, no upper end: the cost stays {within} up to {tried[1]}"
        elif reached[1]:
            text = f"up to {high}, no lower end: the cost stays {within} down to {tried[0]}"
        else:
            text = f"not determined: the cost stays {within} from {tried[0]}, up to {tried[1]}"
        better = self.values[np.argmin(self.rise)]
        if self.rise.min() < -0.1:
            text += f"; the cost is lower at {in_unit(f'{better:.5g}', self.unit)} than at the estimate: start the fit from there"
        return f"{self.name}: {text}"


def check_profiled(names: Iterable[str], free: Iterable[str], declared: Iterable[str], title: str) -> None:
    """Raises ArgumentError where one of ``names`` is not a ``free`` parameter of the model ``title``."""
    free, declared = list(free), list(declared)
    expected = f"expected one of the free parameters: {', '.join(free) or 'there are none'}"
    for name in names:
        if name not in declared:
            problem = f"model {title} has no parameter of that name{did_you_mean(name, declared)}; {expected}"
            raise ArgumentError("profiles", name, problem, option="profile")
        if name not in free:
            raise ArgumentError("profiles", name, f"this parameter is fixed; {expected}", option="profile")


def profile(found: Estimation, simulator: Simulator, name: str, *, settings: Settings = SETTINGS) -> Profile:
    """The profile of the free parameter ``name`` around the estimate ``found``.

    The parameter is held at values that move away from the estimate, in steps that adapt to the rise, until the 95 % level is passed, a
    bound is met, or the simulation fails; the others are estimated again at each, from where they were at the neighbouring value.

    Args:
        simulator: with the tangents of the problem's free parameters.
    """
    run = FreeRun(found.problem, simulator.with_substeps(found.substeps))
    start, index = run.start, found.problem.free_names.index(name)
    colour, deviation = _colour(found, index), found.parameter_deviations("sandwich").get(name, np.inf)
    variance = found.mse * found.samples / max(found.samples - len(start), 1)
    walk = _ProfileRun(run, index, found.mse * found.samples, max(variance * colour, 1e-300), settings)
    lower, upper = (float(bound[index]) for bound in run.bounds)
    here = walk.held(float(start[index]), start)
    step = STEP * deviation if 0 < deviation < np.inf else 0.1 * max(abs(start[index]), 1e-6)
    sides = [walk.walked(here, -step, lower), walk.walked(here, step, upper)]
    middle = [(float(start[index]), 0.0)]
    low, high = _crossing(middle + sides[0]), _crossing(middle + sides[1])
    rows = np.array([*reversed(sides[0]), *middle, *sides[1]])
    if rows[:, 1].min() < -THRESHOLD:
        low = high = None
    unit = next(p.unit for p in found.problem.model.declared_parameters if p.name == name)
    return Profile(
        name=name,
        unit=unit,
        estimate=float(start[index]),
        deviation=float(deviation),
        colour=colour,
        values=rows[:, 0],
        rise=rows[:, 1],
        lower=-np.inf if low is None else low,
        upper=np.inf if high is None else high,
        lower_bound=bool(rows[0, 0] == lower),
        upper_bound=bool(rows[-1, 0] == upper),
    )


@dataclass(frozen=True)
class _ProfileRun:
    """Away from the estimate: one unknown of ``run`` at ``index`` held, the sum of squares compared with ``base`` in units of ``scale``."""

    run: FreeRun
    index: int
    base: float
    scale: float
    settings: Settings

    def held(self, value: float, *begins: np.ndarray) -> Optimum[None] | None:
        """The best of all other unknowns, from the better of some points (d,) on; None where the simulation fails at all of them."""
        run, index = self.run, self.index
        lower, upper = (bound.copy() for bound in run.bounds)
        lower[index] = upper[index] = value
        best, least = None, np.inf
        for begin in begins:
            point = np.clip(begin, lower, upper)
            there = run.quadratic(point) if run.admissible(point) else None
            if there is not None and there.cost < least:
                best, least = point, there.cost
        if best is None:
            return None
        return minimise(run.quadratic, best, lower, upper, settings=self.settings, admissible=run.admissible)

    def rise(self, at: Optimum[None]) -> float:
        """By how much the sum of squares is larger there than at the estimate, in units of ``scale``."""
        return (2 * at.model.cost - self.base) / self.scale

    def walked(self, here: Optimum[None] | None, width: float, bound: float) -> list[tuple[float, float]]:
        """Values and rises in one direction, until the threshold is passed, the ``bound`` is met, or it has gone far enough.

        Steps that fail or leap over the threshold are shortened, as far as that makes sense.
        """
        rows: list[tuple[float, float]] = []
        if here is None:
            return rows
        size = max(abs(float(here.point[self.index])), abs(width))
        for _ in range(POINTS):
            before, risen = float(here.point[self.index]), self.rise(here)
            value = float(min(before + width, bound) if width > 0 else max(before + width, bound))
            if value == before or abs(value) > FAR * size:
                break
            there = self.held(value, _predicted(here, self.index, value), here.point)
            grown = np.inf if there is None else self.rise(there) - risen
            if grown > STEEP * THRESHOLD and abs(width) > size / FAR:
                width *= 0.4
                continue
            if there is None:
                break
            here = there
            rows.append((value, self.rise(here)))
            if rows[-1][1] > 1.15 * THRESHOLD or value == bound:
                break
            width *= 0.6 if grown > 0.4 * THRESHOLD else 1.0 if grown > 0.05 * THRESHOLD else 1.7
        return rows


def _colour(found: Estimation, index: int) -> float:
    """Variance for coloured residuals over the plain one: the parameter's own, or where the data do not determine it the others' median."""
    uncertainty = found.uncertainty
    if uncertainty is None:
        return 1.0
    size = len(found.problem.free_names)
    plain, sandwich = np.diag(uncertainty.plain)[:size], np.diag(uncertainty.sandwich)[:size]
    known = np.setdiff1d(np.flatnonzero(plain > 0), uncertainty.undetermined)
    if index in known:
        return float(sandwich[index] / plain[index])
    return float(np.median(sandwich[known] / plain[known])) if len(known) else 1.0


def _predicted(at: Optimum[None], index: int, value: float) -> np.ndarray:
    """Where the other unknowns would go if the model were linear, the one at ``index`` being moved to ``value``."""
    others = np.arange(len(at.point)) != index
    hessian = at.model.hessian
    scale = np.sqrt(np.maximum(np.diag(hessian)[others], 1e-300))
    matrix = hessian[np.ix_(others, others)] / np.outer(scale, scale)
    pull = hessian[others, index] * (value - at.point[index]) / scale
    result = at.point.copy()
    result[others] -= least_squares(matrix, pull, rcond=1e-6) / scale
    result[index] = value
    return result


def _crossing(rows: list[tuple[float, float]]) -> float | None:
    """Where the rise first passes the threshold on the way from the estimate, its root taken as linear between points, as of a parabola."""
    for (value, rise), (beyond, higher) in pairwise(rows):
        if rise <= THRESHOLD < higher:
            near, far = np.sqrt(max(rise, 0.0)), np.sqrt(higher)
            return float(value + (beyond - value) * (np.sqrt(THRESHOLD) - near) / (far - near))
    return None
