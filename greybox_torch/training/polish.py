"""Gauss-Newton after Adam: windows first, then the free run of whole records, with as much penalty as held-out stretches ask for.

Adam brings the network to where its curve is about right; Gauss-Newton takes the remaining way, which is long and narrow, in some ten
steps. The weight of the penalty is chosen by the held-out stretches, physics alone being one of the choices; then everything is
estimated once more, on all samples of the estimation experiments.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.free_run import FreeRun, descended, simulate
from greybox_torch.estimate.levenberg_marquardt import Optimum, Quadratic, Settings, minimise
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.training.curriculum import Curriculum
from greybox_torch.training.physics import on_whole_records, windows_in_turn, with_physics
from greybox_torch.training.stages import without_samples
from greybox_torch.training.unknowns import Unknowns

WEIGHTS = (1.0, 10.0, 100.0, 1000.0)
"""Penalties that are tried, as multiples of the one of the training."""

WORTH = 0.02
"""Share by which the held-out error must fall for less of a penalty, or for a network at all, to be worth it: physics is preferred."""

WINDOW_SETTINGS = Settings(iterations=25, tolerance=1e-3, trials=6)
RECORD_SETTINGS = Settings(iterations=60, tolerance=1e-6)
LONGEST_PART = 4
"""Windows of this part of the longest record are the last on the way to whole records."""

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

    ``optimum`` is None where physics alone was chosen, or where no free run of the hybrid simulates. ``judged`` is the hybrid of the
    choice, estimated without the held-out stretches; None where physics alone was chosen.
    """

    problem: Problem
    chosen: Choice
    choices: tuple[Choice, ...]
    optimum: Optimum[None] | None
    judged: Problem | None = None

    @property
    def at_an_end(self) -> str:
        """Which of the penalties tried was chosen, "least" or "largest", where none beyond it was; "" elsewhere."""
        tried = sorted(choice.weight for choice in self.choices if choice.weight is not None)
        ends = dict.fromkeys(tried[:1], "least") | dict.fromkeys(tried[1:][-1:], "largest")
        return "" if self.chosen.weight is None else ends.get(self.chosen.weight, "")


@dataclass(frozen=True)
class PenalisedRun:
    """A free run whose cost has the penalty of the network's size added, ``weight`` times the square of each unknown of order one."""

    run: FreeRun
    unknowns: Unknowns
    weight: float

    @property
    def stiffness(self) -> np.ndarray:
        """What the penalty adds to the diagonal of the Hessian (d,)."""
        own = self.weight * self.unknowns.stiffness()
        return np.concatenate([own, np.zeros(len(self.run.start) - len(own))])

    def quadratic(self, z: np.ndarray) -> Quadratic[None] | None:
        """Cost, gradient and Gauss-Newton Hessian, see :meth:`FreeRun.quadratic`."""
        found = self.run.quadratic(z)
        if found is None:
            return None
        count, stiffness = self.run.n_parameters, self.stiffness
        away = np.zeros(len(z))
        away[:count] = z[:count] - self.unknowns.rest * self.unknowns.scale
        cost = found.cost + 0.5 * float(stiffness @ away**2)
        return Quadratic(cost, found.gradient + stiffness * away, found.hessian + np.diag(stiffness), None)

    def minimum(
        self, settings: Settings, told: Callable[[int, float, float], None] | None = None
    ) -> Optimum[None] | None:
        """The optimum that descent from the run's own values leads to; None where they do not simulate."""
        return minimise(
            self.quadratic,
            self.run.start,
            *self.run.bounds,
            settings=settings,
            admissible=self.run.admissible,
            on_iteration=told,
        )


def polish(course: Curriculum, z: np.ndarray, physics: Problem, plain: Simulator, told: Told) -> Polished:
    """From the unknowns ``z`` (d,) that the windows were left with to the optimum of whole records.

    Args:
        physics: the plain model at its own optimum, on the same records, and ``plain`` its simulator.
        told: is told what is being done.
    """
    hybrid = course.unknowns.hybrid.problem
    told("Gauss-Newton on windows")
    begun = [_by_windows(course, course.unknowns.values(point)) for point in (z, course.unknowns.start)]
    alone = _physics_alone(course, physics, plain)
    trials: list[tuple[Choice, Problem]] = []
    first, *others = (factor * course.settings.penalty for factor in WEIGHTS)
    for weight in (first, *others):
        told(f"Gauss-Newton on whole records, penalty {weight:g}")
        found = [trial for start in begun if (trial := _trial(course, start, weight)) is not None]
        if found:
            trials.append(min(found, key=lambda trial: trial[0].held_out))
            begun = [trials[-1][1]]
    choices = (alone, *(choice for choice, _ in trials))
    chosen = plainest(choices)
    if chosen.weight is None:
        return Polished(_at_rest(course.unknowns, hybrid, physics), chosen, choices, None)
    told(f"Gauss-Newton on all samples, penalty {chosen.weight:g}")
    best = next(problem for choice, problem in trials if choice is chosen)
    run = FreeRun(replace(best, records=hybrid.records), course.simulator)
    optimum = PenalisedRun(run, course.unknowns, chosen.weight * course.mean_square).minimum(LAST_SETTINGS)
    return Polished(run.problem if optimum is None else run.at(optimum.point), chosen, choices, optimum, best)


def plainest(choices: Sequence[Choice]) -> Choice:
    """The choice nearest to physics alone whose held-out error is within :data:`WORTH` of the least: it, else the strongest penalty."""
    least = min(choice.held_out for choice in choices)
    worthy = [choice for choice in choices if choice.held_out <= (1.0 + WORTH) * least]
    return max(worthy, key=lambda c: np.inf if c.weight is None else c.weight)


def _by_windows(course: Curriculum, values: np.ndarray) -> Problem:
    """The hybrid begun at ``values`` (n_p,), led through windows of rising lengths without the held-out stretches."""
    masked = without_samples(course.unknowns.hybrid.problem, course.mask).with_values(values)
    longest = max(course.lengths[-1], int(masked.records.lengths.max()) // LONGEST_PART)
    lengths = [*course.lengths, *([longest] if longest > course.lengths[-1] else [])]
    size = course.unknowns.force
    found = windows_in_turn(masked, course.simulator, lengths, size, WINDOW_SETTINGS)
    return on_whole_records(found[-1], masked) if found else masked


def _trial(course: Curriculum, start: Problem, weight: float) -> tuple[Choice, Problem] | None:
    run = FreeRun(start, course.simulator)
    optimum = PenalisedRun(run, course.unknowns, weight * course.mean_square).minimum(RECORD_SETTINGS)
    if optimum is None:
        return None
    at = run.at(optimum.point)
    return Choice(weight, held_out_error(course.unknowns.hybrid.problem, at, course.simulator, course)), at


def held_out_error(complete: Problem, at: Problem, simulator: Simulator, course: Curriculum) -> float:
    """Mean squared weighted error of the free run of ``at`` on the held-out samples of ``complete``; infinite where it overflows."""
    simulated, mask = np.concatenate(simulate(at, simulator)).T, course.mask
    with np.errstate(all="ignore"):
        errors = ((complete.records.y - simulated) * complete.weights[:, None])[:, mask]
        value = float(np.nanmean(errors**2)) if np.isfinite(simulated).all() else float("inf")
    return value if np.isfinite(value) else float("inf")


def _physics_alone(course: Curriculum, physics: Problem, plain: Simulator) -> Choice:
    """The plain model on the same footing: estimated without the held-out stretches, unless it is frozen."""
    run = FreeRun(without_samples(physics, course.mask), plain)
    optimum = None if course.settings.freeze_physics else descended(run, run.start, RECORD_SETTINGS)
    at = run.problem if optimum is None else run.at(optimum.point)
    return Choice(None, held_out_error(physics, at, plain, course))


def _at_rest(unknowns: Unknowns, hybrid: Problem, physics: Problem) -> Problem:
    """The hybrid with its network at zero and everything else as the physics alone has it."""
    values = np.where(unknowns.hybrid.heights, 0.0, hybrid.values)
    initial = hybrid.initial.copy()
    initial[:, : physics.initial.shape[1]] = physics.initial
    return with_physics(hybrid.with_values(values, initial), physics.values)
