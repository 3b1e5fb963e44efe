"""Gauss-Newton after Adam: windows first, then the free run of whole records, with as much penalty as held-out stretches ask for.

Adam brings the network to where its curve is about right; Gauss-Newton takes the remaining way, which is long and narrow, in some ten
steps. The weight of the penalty is chosen by the held-out stretches, physics alone being one of the choices; then everything is
estimated once more, on all samples of the estimation experiments.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.free_run import FreeRun, simulate
from greybox_torch.estimate.levenberg_marquardt import Optimum, Quadratic, Settings, minimise
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import fit_windows
from greybox_torch.simulate.stepper import Stepper
from greybox_torch.train.course import without_samples
from greybox_torch.train.lessons import Course
from greybox_torch.train.unknowns import Unknowns

WEIGHTS = (1.0, 10.0, 100.0)
"""Penalties that are tried, as multiples of the one of the training."""

WINDOW_SETTINGS = Settings(iterations=25, tolerance=1e-3, trials=6)
RECORD_SETTINGS = Settings(iterations=60, tolerance=1e-6)
LAST_SETTINGS = Settings(iterations=100, tolerance=1e-8)

Told = Callable[[str], None]


@dataclass(frozen=True)
class Choice:
    """One way to weigh the penalty, None for physics alone, and the mean squared error of the free run on the held-out stretches."""

    weight: float | None
    held_out: float


@dataclass(frozen=True)
class Polished:
    """The hybrid's problem at its optimum on whole records, which choice that is, and all that there were.

    ``optimum`` is None where physics alone was chosen, or where no free run of the hybrid simulates.
    """

    problem: Problem
    chosen: Choice
    choices: tuple[Choice, ...]
    optimum: Optimum[None] | None


@dataclass(frozen=True)
class PenalisedRun:
    """A free run whose cost has the penalty of the network's size added, ``weight`` times the square of each unknown of order one."""

    run: FreeRun
    unknowns: Unknowns
    weight: float

    def quadratic(self, z: np.ndarray) -> Quadratic[None] | None:
        """Cost, gradient and Gauss-Newton Hessian, see :meth:`FreeRun.quadratic`."""
        found = self.run.quadratic(z)
        if found is None:
            return None
        count = self.run.n_parameters
        stiffness = np.zeros(len(z))
        stiffness[:count] = self.weight * self.unknowns.stiffness()
        away = np.zeros(len(z))
        away[:count] = z[:count] - self.unknowns.rest * self.unknowns.scale
        cost = found.cost + 0.5 * float(stiffness @ away**2)
        return Quadratic(cost, found.gradient + stiffness * away, found.hessian + np.diag(stiffness), None)

    def minimum(self, settings: Settings, told: Callable[[int, float, float], None] | None = None) -> Optimum[None] | None:
        """The optimum that descent from the run's own values leads to; None where they do not simulate."""
        return minimise(
            self.quadratic,
            self.run.start,
            *self.run.bounds,
            settings=settings,
            admissible=self.run.admissible,
            on_iteration=told,
        )


def polish(course: Course, z: np.ndarray, starts: np.ndarray, physics: Problem, plain: Stepper, told: Told) -> Polished:
    """From the unknowns ``z`` (d,) that the windows were left with to the optimum of whole records.

    Args:
        starts: of the longest windows, (W, n_x).
        physics: the plain model at its own optimum, on the same records, and ``plain`` its stepper.
        told: is told what is being done.
    """
    hybrid = course.unknowns.problem(z)
    told("Gauss-Newton on windows")
    masked = without_samples(hybrid, course.mask)
    windows = fit_windows(
        masked, course.stepper, course.lengths[-1], starts=starts, substeps=course.substeps, settings=WINDOW_SETTINGS
    )
    begun = masked if windows is None else masked.with_values(windows.problem.values)
    choices, found = [_physics_alone(course, physics, plain)], {}
    for factor in WEIGHTS:
        weight = factor * course.settings.penalty
        told(f"Gauss-Newton on whole records, penalty {weight:g}")
        for start in (begun, masked):
            run = FreeRun(start, course.stepper, course.substeps)
            optimum = _run(course, run, weight).minimum(RECORD_SETTINGS)
            if optimum is not None:
                at = run.at(optimum.point)
                choice = Choice(weight, held_out_error(hybrid, at, course))
                if choice.held_out < min((c.held_out for c in choices if c.weight == weight), default=np.inf):
                    found[choice] = at
                choices.append(choice)
    chosen = min(choices, key=lambda c: c.held_out)
    if chosen.weight is None:
        return Polished(_at_rest(course.unknowns, hybrid, physics), chosen, tuple(choices), None)
    told(f"on all samples, penalty {chosen.weight:g}")
    everything = hybrid.with_values(found[chosen].values, found[chosen].initial)
    run = FreeRun(everything, course.stepper, course.substeps)
    optimum = _run(course, run, chosen.weight).minimum(LAST_SETTINGS)
    if optimum is None:
        return Polished(everything, chosen, tuple(choices), None)
    return Polished(run.at(optimum.point), chosen, tuple(choices), optimum)


def held_out_error(complete: Problem, at: Problem, course: Course) -> float:
    """Mean squared weighted error of the free run of ``at`` on the held-out samples of ``complete``; infinite where it overflows."""
    simulated = np.concatenate(simulate(at, course.stepper, substeps=course.substeps)).T
    return _error(complete, simulated, course.mask)


def _error(complete: Problem, simulated: np.ndarray, mask: np.ndarray) -> float:
    with np.errstate(all="ignore"):
        errors = ((complete.tape.y - simulated) * complete.weights[:, None])[:, mask]
        value = float(np.nanmean(errors**2)) if np.isfinite(simulated).all() else float("inf")
    return value if np.isfinite(value) else float("inf")


def _run(course: Course, run: FreeRun, weight: float) -> PenalisedRun:
    return PenalisedRun(run, course.unknowns, weight * course.mean_square)


def _physics_alone(course: Course, physics: Problem, plain: Stepper) -> Choice:
    """The plain model on the same footing: estimated without the held-out stretches, unless it is frozen."""
    run = FreeRun(without_samples(physics, course.mask), plain, course.substeps)
    optimum = None if course.settings.freeze_physics else minimise(
        run.quadratic, run.start, *run.bounds, settings=RECORD_SETTINGS, admissible=run.admissible
    )
    at = run.problem if optimum is None else run.at(optimum.point)
    simulated = np.concatenate(simulate(at, plain, substeps=course.substeps)).T
    return Choice(None, _error(physics, simulated, course.mask))


def _at_rest(unknowns: Unknowns, hybrid: Problem, physics: Problem) -> Problem:
    """The hybrid with its network at zero and everything else as the physics alone has it."""
    values, own = hybrid.values.copy(), dict(zip(physics.names, physics.values, strict=True))
    for k, name in enumerate(hybrid.names):
        values[k] = own.get(name, 0.0 if unknowns.hybrid.heights[k] else hybrid.values[k])
    return hybrid.with_values(values)
