"""Looking for other valleys of the cost: many start values around the given ones, followed side by side, the distinct ones to the end.

A flexible machine has optima that exchange the roles of its resonances; from poor start values a single descent ends in whichever
comes first. Members are told apart by what they simulate, not by their parameters, so that a flat valley counts once.

Source: multi-level single linkage in spirit (A. H. G. Rinnooy Kan and G. T. Timmer, 1987).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from greybox_torch.estimate.plateau import off_the_plateau
from greybox_torch.estimate.population import Members, Population, improve, sorted_by_cost
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator

SPREAD, WIDE_SPREAD = 6.0, 15.0
"""Factors up or down within which start values are drawn, and those of parameters that do not matter at the best place found."""

ROUGH_SHARE, ROUGH_SAMPLES, ROUGH_ITERATIONS = 0.25, 6000, 30
"""The first descent sees this share of every experiment, and no more samples than this in all."""

FINE_SAMPLES, FINE_ITERATIONS = 60_000, 40
"""The second one sees the whole records, if they are no longer than this."""

SURVIVORS, LEADING = 32, 0.5
"""How many distinct members the second descent follows, and which share of either goes on after a third of its iterations: valleys that
are deep in the end need not lead early."""

DISTINCT = 0.2
"""Difference between two simulations, in units of the error, from which they count as two."""

TURNS = 2
"""How often, at most, the search begins."""

BEHIND = 1.1
"""How many times the error of what is to be beaten a turn may leave. From poor starts of the real arm a second turn lowered the error by a
factor of 1.04 at the most where it led to the best, and by 1.11 where it stayed behind all the same."""


@dataclass(frozen=True)
class Elsewhere:
    """Where a search has come to, and the sub-steps that it was found with: with fewer, a descent from there may leave the valley for
    what errors of the integration make of it.
    """

    problem: Problem
    substeps: int


def look_around(
    problem: Problem,
    simulator: Simulator,
    *,
    starts: int,
    seed: int = 0,
    progress: Callable[[str, int, float], None] | None = None,
    to_beat: float = float("inf"),
    turns: int = TURNS,
) -> Elsewhere | None:
    """The best of what ``starts`` descents from start values around those of ``problem`` found; None where none simulates.

    None as well where the best of a turn is clearly behind ``to_beat``, a mean squared error.

    What does not matter at the best place found is then drawn anew, see :mod:`greybox_torch.estimate.plateau`, where that pays and there
    is another of the ``turns``.
    Results are rough: they are where a local estimation should begin.
    """
    generator = np.random.default_rng(seed)
    population = _followed(problem, simulator, _drawn(problem, starts, SPREAD, generator))
    members = _whole(problem, simulator)
    for turn in range(1, turns + 1):
        if not len(population):
            return None
        reached = 2.0 * float(population.cost[0]) / members.problem.samples
        if progress is not None:
            progress(f"search from {starts} starts", turn, reached)
        if reached > BEHIND * to_beat:
            return None
        if turn == turns:
            break
        draw = partial(_drawn, problem, spread=WIDE_SPREAD, generator=generator)
        found = off_the_plateau(members, population.selected(slice(1)), draw, starts, generator)
        if found is None:
            break
        members, population = found
    return Elsewhere(problem.with_values(population.values[0], population.initial[0]), members.simulator.substeps)


def _followed(problem: Problem, simulator: Simulator, population: Population) -> Population:
    """Where descents from ``population`` end, the distinct ones, best first."""
    part = _beginning(problem.driving_records, ROUGH_SHARE, ROUGH_SAMPLES)
    rough, fine = Members(replace(problem, records=part), part, simulator), _whole(problem, simulator)
    leading = max(SURVIVORS, round(LEADING * len(population)))
    population = _descended(rough, population, ROUGH_ITERATIONS, leading)
    population = _distinct(rough, population)
    return _descended(fine, population, FINE_ITERATIONS, round(LEADING * SURVIVORS)) if len(population) else population


def _descended(members: Members, population: Population, iterations: int, leading: int) -> Population:
    """Those of ``population`` that lead after a third of the iterations, where they are after all, best first."""
    early = iterations // 3
    led = sorted_by_cost(improve(members, population, early)).selected(slice(leading))
    return sorted_by_cost(improve(members, led, iterations - early)) if len(led) else led


def _whole(problem: Problem, simulator: Simulator) -> Members:
    part = _beginning(problem.driving_records, 1.0, FINE_SAMPLES)
    return Members(replace(problem, records=part), part, simulator)


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
