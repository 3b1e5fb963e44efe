"""Leaving a plateau of the cost: what does not matter at a place is drawn anew, and of many draws ever fewer descend ever farther.

Where a friction level is zero, the shape of that friction has no slope: the place is a plateau in those directions, not a valley. By
their cost as drawn the best draws would be those that do nothing, as the other parameters have not followed yet: so all descend a little
before they are compared, and those that have come to do nothing are given up.

Source: successive halving (K. Jamieson and A. Talwalkar, "Non-stochastic best arm identification and hyperparameter optimization", 2016).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.logarithmic_members import LogarithmicMembers
from greybox_torch.estimate.population import Members, Population, improve, sorted_by_cost
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.substeps import LARGEST

UNCERTAIN = 0.3
"""Relative deviation from which a parameter does not matter."""

JITTER = 0.1
"""By how much what matters is moved."""

ZERO = 0.5
"""Share of what does not matter and may be zero that begins there: from zero a level rises as its shape asks for. Drawn too high it falls,
and most often to nothing, before its shape has changed."""

NOTHING = 0.05
"""Difference from the simulation at the plateau, in units of its error, up to which a draw does nothing."""

PAYS = 1e-3
"""Share of the cost by which another place has to be better."""

DAMPING = 1.0
"""Draws are far from where a Gauss-Newton step holds: taken whole, it ends on the plateau or is rejected again and again."""


@dataclass(frozen=True)
class Rung:
    """How many members are followed, as a multiple of the starts, for how many iterations, and with steps how many times as fine.

    The fewer are left, the finer their steps: a place must not be good for the errors of its integration, nor be left for a place that is.
    """

    share: float
    iterations: int
    finer: int


RUNGS = (Rung(1.5, 6, 1), Rung(1 / 4, 11, 2), Rung(1 / 16, 11, 8), Rung(1 / 64, 6, 16))
"""Most of the passes are in the first, few in the last: what is left to do there a local estimation does as well."""


def off_the_plateau(
    members: Members, best: Population, draw: Callable[[int], Population], starts: int, generator: np.random.Generator
) -> tuple[Members, Population] | None:
    """Places better than ``best``, a single member, best first, and with which steps they were found.

    None where nothing better was found, or everything matters there.

    Args:
        draw: that many start values, from which what does not matter is taken.
    """
    idle = np.zeros(len(members.problem.values), dtype=bool)
    cost, _, hessian = members.normals(best)
    idle[members.problem.free] = idle_at(members.problem, best.values[0], float(cost[0]), hessian[0])
    if not idle.any():
        return None
    finer, population = members, draw(_count(RUNGS[0], starts))
    population = _drawn_anew(members.problem, best, idle, population, generator)
    for rung in RUNGS:
        if not len(population):
            return None
        chosen = population.selected(slice(_count(rung, starts)))
        finer = _finer(members, rung.finer)
        descended = improve(LogarithmicMembers.of(finer, chosen), chosen, rung.iterations, DAMPING)
        population = _effective(finer, sorted_by_cost(descended), best)
    better = population.selected(population.cost < (1.0 - PAYS) * best.cost[0])
    return (finer, better) if len(better) else None


def idle_at(problem: Problem, values: np.ndarray, cost: float, hessian: np.ndarray) -> np.ndarray:
    """Which free parameters (n_free,) are at a bound, or do hardly anything there that those which matter more could not do as well.

    Two levels of which only the sum is seen both look determined; beside the larger one, the other could as well be something else.
    """
    free = problem.free
    size = UNCERTAIN * values[free]
    left = hessian[: len(size), : len(size)] * size[:, None] * size
    at_bound = (values[free] <= problem.lower[free]) | (values[free] >= problem.upper[free])
    idle = np.ones(len(size), dtype=bool)
    for _ in size:  # pivoted elimination
        effect = np.where(idle & ~at_bound, np.diag(left), 0.0)
        most = int(np.argmax(effect))
        if effect[most] <= 2.0 * cost / problem.samples:
            break
        idle[most] = False
        left = left - np.outer(left[:, most], left[most]) / left[most, most]
    return idle


def _count(rung: Rung, starts: int) -> int:
    return max(1, round(rung.share * starts))


def _finer(members: Members, times: int) -> Members:
    """With steps that many times as fine, but not finer than any that accuracy asks for."""
    here = members.simulator
    return replace(members, simulator=here.with_substeps(max(here.substeps, min(times * here.substeps, LARGEST))))


def _drawn_anew(
    problem: Problem, best: Population, idle: np.ndarray, drawn: Population, generator: np.random.Generator
) -> Population:
    """``best`` with what is ``idle`` there as in ``drawn``, or zero, and the rest almost as it is."""
    jitter = np.exp(generator.uniform(-JITTER, JITTER, drawn.values.shape))
    moved = np.where(problem.free, np.clip(best.values * jitter, problem.lower, problem.upper), best.values)
    values = np.where(idle, drawn.values, moved)
    zero = (generator.uniform(size=values.shape) < ZERO) & idle & (problem.lower <= 0.0) & (problem.upper >= 0.0)
    values = np.where(zero, 0.0, values)
    values = values[problem.all_admissible(values)]
    return Population(values, np.repeat(best.initial, len(values), axis=0), np.full(len(values), np.inf))


def _effective(members: Members, population: Population, plateau: Population) -> Population:
    """Those that are better than the plateau or simulate something else."""
    if not len(population):
        return population
    here, cost = members.outputs(plateau), float(plateau.cost[0])
    parts = []
    for part in np.array_split(np.arange(len(population)), -(-len(population) // 64)):
        with np.errstate(all="ignore"):  # of outputs that are large
            parts.append(((members.outputs(population.selected(part)) - here) ** 2).sum(axis=1))
    far = np.concatenate(parts) > NOTHING**2 * 2.0 * cost
    return population.selected(far | (population.cost < (1.0 - PAYS) * cost))
