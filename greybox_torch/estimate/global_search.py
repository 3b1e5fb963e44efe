"""Looking for other valleys of the cost: many start values around the given ones, followed side by side, the distinct ones to the end.

A flexible machine has optima that exchange the roles of its resonances; from poor start values a single descent ends in whichever
comes first. Members are told apart by what they simulate, not by their parameters, so that a flat valley counts once.

Source: multi-level single linkage in spirit (A. H. G. Rinnooy Kan and G. T. Timmer, 1987).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from greybox_torch.estimate.population import Members, Population, improve
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.substeps import choose_substeps

SPREAD, WIDE_SPREAD = 6.0, 15.0
"""Factors up or down within which start values are drawn, and those of parameters that do not matter at the best place found."""

ROUGH_SHARE, ROUGH_SAMPLES, ROUGH_ITERATIONS = 0.25, 6000, 30
"""The first descent sees this share of every experiment, and no more samples than this in all."""

FINE_SAMPLES, FINE_ITERATIONS = 60_000, 40
"""The second one sees the whole records, if they are no longer than this."""

SURVIVORS = 32
"""How many distinct members the second descent follows."""

DISTINCT = 0.2
"""Difference between two simulations, in units of the error, from which they count as two."""

TURNS, SCREENED = 2, 8
"""How often, at most, the search begins, and how many times as many draws are then simulated once to choose where to descend."""

BEHIND = 1.1
"""How many times the error of what is to be beaten a turn may leave. From poor starts of the real arm a second turn lowered the error by a
factor of 1.04 at the most where it led to the best, and by 1.11 where it stayed behind all the same."""

FINER, FINEST = 2, 4
"""How much finer the steps are when what does not matter is drawn anew, as that may be stiff, and how fine they are at most."""

JITTER, UNCERTAIN = 0.1, 0.3
"""By how much what matters is moved then; relative deviation from which a parameter does not matter."""


def look_around(
    problem: Problem,
    simulator: Simulator,
    *,
    starts: int,
    seed: int = 0,
    progress: Callable[[str, int, float], None] | None = None,
    to_beat: float = float("inf"),
) -> Problem | None:
    """The best of what ``starts`` descents from start values around those of ``problem`` found; None where none simulates.

    None as well where the best of a turn is clearly behind ``to_beat``, a mean squared error.

    What does not matter at the best place found is then drawn anew, and descents begin from the best of these, as long as that pays.
    Results are rough: they are where a local estimation should begin.
    """
    generator = np.random.default_rng(seed)
    population = _followed(problem, simulator, _drawn(problem, starts, SPREAD, generator))
    fine = _whole(problem, simulator)
    for turn in range(1, TURNS + 1):
        if not len(population):
            return None
        reached = 2.0 * float(population.cost[0]) / fine.problem.samples
        if progress is not None:
            progress(f"search from {starts} starts", turn, reached)
        if reached > BEHIND * to_beat:
            return None
        if turn == TURNS:
            break
        fine = _whole(problem, simulator.with_substeps(max(FINER * simulator.substeps, _finer(fine, population))))
        around = _drawn_anew(fine, population, _drawn(problem, SCREENED * starts, WIDE_SPREAD, generator), generator)
        found = _sorted(improve(fine, _promising(fine, around, starts // 4), FINE_ITERATIONS))
        if not len(found) or found.cost[0] > (1.0 - 1e-3) * population.cost[0]:
            break
        population = found
    return problem.with_values(population.values[0], population.initial[0])


def _followed(problem: Problem, simulator: Simulator, population: Population) -> Population:
    """Where descents from ``population`` end, the distinct ones, best first."""
    part = _beginning(problem.driving_records, ROUGH_SHARE, ROUGH_SAMPLES)
    rough = Members(replace(problem, records=part), part, simulator)
    population = _distinct(rough, improve(rough, population, ROUGH_ITERATIONS))
    if not len(population):
        return population
    return _sorted(improve(_whole(problem, simulator), population, FINE_ITERATIONS))


def _sorted(population: Population) -> Population:
    """Those that simulate, best first."""
    return population.selected(np.argsort(population.cost)[: int(np.isfinite(population.cost).sum())])


def _promising(members: Members, population: Population, most: int) -> Population:
    """Those whose simulation is nearest to the measurement as they are."""
    parts = [
        members.costs(population.selected(part))
        for part in np.array_split(np.arange(len(population)), -(-len(population) // 256))
    ]
    return _sorted(Population(population.values, population.initial, np.concatenate(parts))).selected(slice(most))


def _whole(problem: Problem, simulator: Simulator) -> Members:
    part = _beginning(problem.driving_records, 1.0, FINE_SAMPLES)
    return Members(replace(problem, records=part), part, simulator)


def _finer(members: Members, population: Population) -> int:
    """Sub-steps that the best of ``population`` needs: a place must not be good for the errors of its integration."""
    needed = choose_substeps(members.records, members.simulator.stepper, population.values[0], population.initial[0])
    return min(FINEST, max(members.simulator.substeps, needed or FINEST))


def _drawn(problem: Problem, count: int, spread: float, generator: np.random.Generator) -> Population:
    """The given start values and others around them, log-uniformly within a factor; those that break a joint constraint drawn again."""
    rows = [problem.values]
    for _ in range(50 * count):
        if len(rows) == count:
            break
        factors = np.exp(generator.uniform(-np.log(spread), np.log(spread), len(problem.values)))
        drawn = np.where(problem.free, np.clip(problem.values * factors, problem.lower, problem.upper), problem.values)
        if problem.admissible(drawn):
            rows.append(drawn)
    values = np.array(rows)
    return Population(values, np.repeat(problem.initial[None], len(values), axis=0), np.full(len(values), np.inf))


def _drawn_anew(
    members: Members, population: Population, drawn: Population, generator: np.random.Generator
) -> Population:
    """The best of ``population`` with what does not matter there as in ``drawn``, and the rest almost as it is.

    Where a friction level is zero, the shape of that friction has no slope: the place is a plateau in those directions, not a valley.
    """
    best = population.selected(np.zeros(1, dtype=np.int64))
    problem = members.problem
    cost, _, hessian = members.normals(best)
    idle = np.zeros(len(problem.values), dtype=bool)
    idle[problem.free] = _idle(problem, best.values[0], float(cost[0]), hessian[0])
    jitter = np.exp(generator.uniform(-JITTER, JITTER, drawn.values.shape))
    moved = np.where(problem.free, np.clip(best.values * jitter, problem.lower, problem.upper), best.values)
    values = np.where(idle, drawn.values, moved)
    values = np.concatenate([best.values, values[problem.all_admissible(values)]])
    return Population(values, np.repeat(best.initial, len(values), axis=0), np.full(len(values), np.inf))


def _idle(problem: Problem, values: np.ndarray, cost: float, hessian: np.ndarray) -> np.ndarray:
    """Which free parameters (n_free,) are at a bound, or so little determined that they could as well be something else."""
    free = problem.free
    n_p = int(free.sum())
    variance = 2.0 * cost / problem.samples
    curvature = np.diag(hessian)[:n_p]
    at_bound = (values[free] <= problem.lower[free]) | (values[free] >= problem.upper[free])
    return at_bound | (curvature * values[free] ** 2 * UNCERTAIN**2 < variance)


def _distinct(members: Members, population: Population) -> Population:
    """The best members, best first, of those that simulate different things."""
    order = np.argsort(population.cost)[: int(np.isfinite(population.cost).sum())]
    if not len(order):
        return population.selected(order)
    outputs = members.outputs(population.selected(order))
    chosen: list[int] = []
    for k, cost in enumerate(population.cost[order]):
        limit = DISTINCT**2 * 2.0 * cost
        if all(float(((outputs[k] - outputs[j]) ** 2).sum()) > limit for j in chosen):
            chosen.append(k)
        if len(chosen) == SURVIVORS:
            break
    return population.selected(order[chosen])


def _beginning(records: Records, share: float, most: int) -> Records:
    """The first part of every experiment, ``most`` samples in all."""
    share = min(share, most / int(records.lengths.sum()))
    if share >= 1.0:
        return records
    lengths = np.maximum(10, (share * records.lengths).astype(int))
    spans = [
        slice(int(a), int(a + min(n, whole)))
        for a, n, whole in zip(records.first, lengths, records.lengths, strict=True)
    ]
    return records.part(spans, records.names)
