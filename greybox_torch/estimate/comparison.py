"""Simulated against measured, experiment by experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from greybox_torch.data import Recording
from greybox_torch.estimate.free_run import simulate
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.metrics import fit_percent, root_mean_square
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.simulator import Simulator

START, AUGMENTED = "start", "augmented"
MODELS = (START, "refit", AUGMENTED)
"""The models that a diagnosis compares: with the card's values, re-estimated, and with the effects found."""

MOST = 0.7
"""Share of the error from which it is said to be in one output."""


@dataclass(frozen=True)
class Score:
    """Fit in % and root mean square error (in the output's unit) of one output in one experiment."""

    experiment: str
    role: str
    output: str
    fit: float
    rmse: float


@dataclass(frozen=True)
class Comparison:
    """Scores, and of every experiment its name, the simulated outputs (N_e, n_y) and the start states (n_x,) that they began with."""

    scores: tuple[Score, ...]
    experiments: tuple[str, ...]
    simulated: tuple[np.ndarray, ...]
    initial: tuple[np.ndarray, ...]

    @property
    def by_experiment(self) -> dict[str, np.ndarray]:
        """The simulated outputs (N_e, n_y)."""
        return dict(zip(self.experiments, self.simulated, strict=True))

    def with_experiments_of(self, other: Comparison) -> Comparison:
        """The experiments that ``other`` has as they are there, the rest as here."""
        scores = {(s.experiment, s.output): s for s in other.scores}
        places = {name: e for e, name in enumerate(other.experiments)}
        pick = [(other, places[name]) if name in places else (self, e) for e, name in enumerate(self.experiments)]
        return Comparison(
            tuple(scores.get((s.experiment, s.output), s) for s in self.scores),
            self.experiments,
            tuple(of.simulated[e] for of, e in pick),
            tuple(of.initial[e] for of, e in pick),
        )


def compare(
    problem: Problem,
    recordings: Sequence[Recording],
    simulator: Simulator,
    *,
    estimate_starts: bool = True,
) -> Comparison:
    """Free-run simulation of every experiment of ``problem`` against its measurement.

    Args:
        recordings: the recordings that the problem's records was made of, for names and roles.
        estimate_starts: estimate the free start states on the first tenth of each experiment before.
    """
    if estimate_starts:
        problem = estimate_initial(problem, simulator)
    return compared(problem, recordings, simulate(problem, simulator))


def compared(problem: Problem, recordings: Sequence[Recording], simulated: Sequence[np.ndarray]) -> Comparison:
    """Simulated outputs (N_e, n_y) of every experiment of ``problem`` against its measurement."""
    scores = []
    for e, recording in enumerate(recordings):
        for k, output in enumerate(problem.model.outputs):
            measured = problem.records.y[k, problem.records.span(e)]
            values = simulated[e][:, k]
            scores.append(
                Score(
                    recording.name,
                    recording.role,
                    output.name,
                    fit_percent(measured, values),
                    root_mean_square(measured, values),
                )
            )
    return Comparison(tuple(scores), problem.records.names, tuple(simulated), tuple(problem.initial))


def held_out_scores(scores: Sequence[Score]) -> list[Score]:
    """Those on validation experiments, or all where there are none."""
    return [s for s in scores if s.role == "validation"] or list(scores)


def of_moving_outputs(scores: Sequence[Score]) -> list[Score]:
    """Without those of outputs that stand still, of which a fit says nothing."""
    return [s for s in scores if s.fit > -np.inf or not np.isfinite(s.rmse)]


def mostly_in(scores: Sequence[Score]) -> str:
    """The output of several that has most of the squared error, each output in its own spread; "" where none stands out."""
    judging = [s for s in of_moving_outputs(held_out_scores(scores)) if np.isfinite(s.fit)]
    errors: dict[str, float] = {}
    for s in judging:
        errors[s.output] = errors.get(s.output, 0.0) + (1.0 - s.fit / 100.0) ** 2
    largest = max(errors, key=errors.__getitem__, default="")
    return largest if len(errors) > 1 and errors[largest] > MOST * sum(errors.values()) else ""


def mean_fit(scores: Sequence[Score]) -> float:
    """Mean fit in %, of the outputs that move; minus infinity where a run overflows, zero where nothing moves."""
    moving = of_moving_outputs(scores)
    return float(np.mean([s.fit for s in moving])) if moving else 0.0


def fits_by_output(scores: Sequence[Score]) -> dict[str, float]:
    """The mean fit in % of each output that has scores."""
    return {name: mean_fit([s for s in scores if s.output == name]) for name in dict.fromkeys(s.output for s in scores)}


def fit_rows(scores: Mapping[str, Sequence[Score]]) -> list[dict[str, Any]]:
    """The rows ``fit`` of `verdict.json` from scores by model name ("start", "refit", "augmented"), each in the same order."""
    rows = []
    for of_one in zip(*(scores[m] for m in MODELS), strict=True):
        row: dict[str, Any] = {n: getattr(of_one[0], n) for n in ("experiment", "role", "output")}
        rows.append(row | {m: {"fit": s.fit, "rmse": s.rmse} for m, s in zip(MODELS, of_one, strict=True)})
    return rows
