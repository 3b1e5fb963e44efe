"""Row 8: whether estimation arrives from poor start values."""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass

import numpy as np

from experiments.speed.records import load_problem
from experiments.speed.row import Entry, Row, Target
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import ALL_FREE_CARD, Settings
from greybox_torch.estimate import Problem, fit_percent, fit_records, simulate
from greybox_torch.simulation import Simulator

TITLE = "Start values within a factor of 2 of the card's, 12 free parameters, real arm"
NEEDS = Needs(recordings=True)
NEAR = 0.1
"""Fit points within which two optima count as one."""


@dataclass(frozen=True)
class Arrival:
    """Where one estimation ended: its fit in % on the estimation experiment (−inf where it failed), time in s, what went wrong."""

    fit: float
    seconds: float
    failure: str = ""


def drawn(problem: Problem, rng: np.random.Generator) -> Problem:
    """Free parameters multiplied by factors whose logarithm is uniform between those of 1/2 and 2, within bounds and constraints.

    Draws that break a joint constraint of the model (inertia shares that sum to more than one) are drawn again. A parameter that the card
    starts at zero stays there.
    """
    while True:
        factors = np.where(problem.free, 2.0 ** rng.uniform(-1.0, 1.0, len(problem.values)), 1.0)
        values = np.clip(problem.values * factors, problem.lower, problem.upper)
        if problem.admissible(values):
            return problem.with_values(values)


def measure(settings: Settings, progress: Progress) -> Row:
    problem = load_problem(ALL_FREE_CARD)
    simulator = Simulator.of(problem.model, problem.free_names)
    rng, arrivals = np.random.default_rng(settings.seed), []
    count = min(settings.draws, 3) if settings.quick else settings.draws
    for draw in range(count):
        arrivals.append(_arrival(drawn(problem, rng), simulator))
        last = arrivals[-1]
        progress(f"draw {draw + 1} of {count}: {last.failure or f'fit {last.fit:.3f} %'} in {last.seconds:.1f} s")
    best = max(a.fit for a in arrivals)
    share = 100.0 * float(np.mean([a.fit >= best - NEAR for a in arrivals]))
    failures = [a.failure for a in arrivals if a.failure]
    return Row(
        "robustness",
        TITLE,
        entries=(Entry("ours, fit (median)", float(np.median([a.seconds for a in arrivals])), ours=True),),
        targets=(
            Target(f"share of {count} draws within {NEAR} fit points of the best", "at least", 95.0, share, unit=" %"),
            Target("estimations that fail", "at most", 0.0, float(len(failures)), unit=""),
        ),
        agreement=f"best fit {best:.3f} %; all: "
        + ", ".join(f"{a.fit:.2f}" for a in sorted(arrivals, key=lambda a: a.fit)),
        notes=tuple(sorted(set(failures))),
    )


def _arrival(problem: Problem, simulator: Simulator) -> Arrival:
    began = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # overflow of a trial step is part of the work
            found = fit_records(problem, simulator=simulator, with_uncertainty=False)
            simulated = simulate(found.problem, simulator.with_substeps(found.substeps))[0][:, 0]
        share = fit_percent(problem.records.y[0], simulated)
    except Exception as error:  # a crash of any kind is what is counted here
        return Arrival(float("-inf"), time.perf_counter() - began, f"{type(error).__name__}: {error}")
    failure = "" if np.isfinite(share) and np.isfinite(found.mse) else "the estimate does not simulate"
    return Arrival(share, time.perf_counter() - began, failure)
