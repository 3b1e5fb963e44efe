"""The re-tuned plain model: the first thing an engineer tries, where the other ways begin, and what all of them are measured against."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from greybox_torch import DataSet, DiagnosisSettings, NumericalError, Surroundings, UserError, load_dataset, load_model
from greybox_torch.diagnosis.hypothesis import finish, hypothesis, noise_floor, window_lengths
from greybox_torch.estimate import (
    Problem,
    Score,
    WindowFit,
    all_starts_free,
    compare,
    fit_windows,
    make_problem,
    simulator_for,
    survey,
)
from greybox_torch.simulation import Simulator

CHOSEN_ON = 0.3
"""The last share of the estimation experiments, on which the other ways choose among their own variants."""


@dataclass(frozen=True)
class Plain:
    """A case with its model re-tuned.

    ``problem`` is on the estimation experiments at the optimum, ``card`` at the card's values; ``simulator`` has no tangents.
    """

    data: DataSet
    card: Problem
    problem: Problem
    simulator: Simulator
    seconds: float

    @cached_property
    def surroundings(self) -> dict[str, Surroundings]:
        """Where the signals around every port moved."""
        return survey(self.problem.model, self.problem, self.simulator)

    @cached_property
    def noise(self) -> np.ndarray:
        """Standard deviation (n_y,) of each output's noise, from the recordings alone."""
        rows = []
        for k in range(len(self.problem.records.y)):
            alone = replace(self.problem.records, y=self.problem.records.y[k : k + 1])
            rows.append(
                np.sqrt(noise_floor(replace(self.problem, records=alone, weights=np.ones(1)), DiagnosisSettings()))
            )
        return np.maximum(np.array(rows), 1e-9 * np.nanstd(self.problem.records.y, axis=1))

    @property
    def length(self) -> int:
        """Samples of the windows on which variants are compared: a sixteenth of the longest record."""
        return window_lengths(self.problem)[:2][-1]

    @cached_property
    def windows(self) -> WindowFit:
        """The start states of those windows at the re-tuned parameters."""
        found = fit_windows(self._rest, self.simulator, self.length)
        if found is None:
            raise NumericalError(f"{self.data.path}: the re-tuned model overflows over {self.length} samples")
        return found

    @property
    def _rest(self) -> Problem:
        return replace(self.problem, free=np.zeros_like(self.problem.free))

    @cached_property
    def scores(self) -> dict[str, tuple[Score, ...]]:
        """On the held-out experiments in free run: the card's values ("start") and the re-tuned ones ("refit")."""
        problems = {"start": self.judged.with_values(self.card.values), "refit": self.judged}
        return {name: self.free_run(problem) for name, problem in problems.items()}

    def free_run(self, problem: Problem) -> tuple[Score, ...]:
        """Free runs of a problem on the held-out experiments, start states from the first tenth of each."""
        return compare(problem, self.data.validation(), self.simulator.for_model(problem.model)).scores

    @cached_property
    def judged(self) -> Problem:
        """The plain model on the held-out experiments, at the re-tuned values."""
        problem = make_problem(self.data, self.problem.model, self.data.validation())
        return all_starts_free(self.data, problem).with_values(self.problem.values)


def retune(card: Path) -> Plain:
    """Estimate all free parameters of a card's model, in the way that the `refit` column of a verdict comes from.

    Raises:
        UserError: the card is not usable, names no model, or has no experiment of one of the two roles.
        NumericalError: the model cannot be simulated from the start values even over short windows.
    """
    began = time.perf_counter()
    data = load_dataset(card)
    if data.model is None:
        raise UserError(f"{card}: [model] name is missing; expected the model that lacks something")
    for role, found in (("estimation", data.estimation()), ("validation", data.validation())):
        if not found:
            raise UserError(f'{card}: [[experiment]] role: no experiment has the role "{role}"; expected at least one')
    model = load_model(data.model)
    problem = all_starts_free(data, make_problem(data, model, data.estimation()))
    simulator = simulator_for(problem)
    tuned = hypothesis(problem, (), {}, [{}], options=simulator.options, simulator=simulator)
    if tuned is None:
        raise NumericalError(
            f"{card}: the model overflows even over short windows; try start values nearer to the truth"
        )
    optimum = finish(tuned).problem
    return Plain(data, problem, optimum, simulator.for_model(model), time.perf_counter() - began)
