"""The same scores for every model: free runs of all experiments, and how far the physical parameters moved."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from greybox_torch import DataSet, GreyBoxModel
from greybox_torch.estimate import Problem, Score, all_starts_free, compare, make_problem, problem_for
from greybox_torch.simulation import SimulationOptions, Simulator

Found = TypeVar("Found")


@dataclass(frozen=True)
class Fits:
    """Mean fits in % over the experiments of each role, and every score."""

    estimation: float
    validation: float
    scores: tuple[Score, ...]

    @staticmethod
    def of(scores: tuple[Score, ...]) -> Fits:
        mean = {r: float(np.mean([s.fit for s in scores if s.role == r])) for r in ("estimation", "validation")}
        return Fits(mean["estimation"], mean["validation"], scores)

    def by_experiment(self) -> dict[str, float]:
        return {f"{s.experiment}: {s.output}": s.fit for s in self.scores}


def fits_of(data: DataSet, base: GreyBoxModel, model: GreyBoxModel, values: Mapping[str, float], substeps: int) -> Fits:
    """Scores of ``model``, which is ``base`` or has it inside, start states from the first tenth of each experiment."""
    start = make_problem(data, base, data.recordings)
    restated = start if model is base else problem_for(start, model, {})
    problem = all_starts_free(data, restated)
    problem = problem.with_values(np.array([values[name] for name in problem.names]))
    return Fits.of(
        compare(problem, data.recordings, Simulator.of(model, (), SimulationOptions(substeps=substeps))).scores
    )


def drift(physics: Problem, values: Mapping[str, float]) -> dict[str, float]:
    """Relative change of every free physical parameter against the re-estimated ``physics``; those that are zero there left out."""
    pairs = zip(physics.names, map(float, physics.values), physics.free, strict=True)
    return {name: values[name] / own - 1.0 for name, own, free in pairs if free and own != 0.0}


def timed(work: Callable[[], Found]) -> tuple[Found, dict[str, Any]]:
    """What ``work`` gives, and how long it took."""
    clock, processor = time.perf_counter(), time.process_time()
    found = work()
    return found, {"seconds": time.perf_counter() - clock, "processor_seconds": time.process_time() - processor}
