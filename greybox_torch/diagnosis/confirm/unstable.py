"""Experiments that no free run follows, as nobody could know their start states well enough.

Where a machine falls into one of many wells, tumbles, or stands near an unstable equilibrium, two runs of one model that begin next to one
another part. A free run that is far from the measurement then says nothing of the model: the true one may look worse than a wrong one.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.hypothesis.noise import output_floors
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.comparison import Comparison, mean_fit
from greybox_torch.estimate.initial import FRACTION
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows


def parted(
    problem: Problem, simulator: Simulator, asked: Collection[str], settings: DiagnosisSettings
) -> dict[str, float]:
    """How far the free runs of experiments part from one that begins next to them, in units of their error, by name.

    Each state in turn begins as far away as sensors do not show; the farthest of them counts, root mean square over the record. A run
    beside it that overflows has parted from it.

    Zero where that is not the machine's doing: a free run that overflows, or that is farther from the measurement than a constant; and
    where the change hardly grows from the first tenth of the record on (``settings.least_growth``), as an offset or a drift does.

    Args:
        problem: with the start states of the free runs.
        asked: names of the experiments.
    """
    rows = [e for e, name in enumerate(problem.records.names) if name in asked]
    floors = output_floors(problem, settings) if rows else np.empty(0)
    return {problem.records.names[e]: _parted(problem, simulator, e, floors[e], settings) for e in rows}


def lost(
    problem: Problem, simulator: Simulator, asked: Collection[str], settings: DiagnosisSettings
) -> dict[str, bool]:
    """The experiments whose free runs end farther from the measurement than a constant is, by name.

    True of those that fall away from an equilibrium: they overflow, or a small change of the start grows, as where free runs part.
    """
    rows = [e for e, name in enumerate(problem.records.names) if name in asked]
    beside = ((problem.records.names[e], _beside(problem, simulator, e, settings)) for e in rows)
    return {name: not runs.finite or bool(runs.grown) for name, runs in beside if not runs.near}


def followed(comparison: Comparison, settings: DiagnosisSettings) -> frozenset[str]:
    """The experiments that a model's free runs do follow (``settings.followed``). Models that both do can be compared there.

    Seen: waves in a spring, told as a curve whose own slopes made free runs part: that left out an experiment which it made worse, of
    95.4 % to 94.6 %.
    """
    names = {s.experiment for s in comparison.scores}
    of = {name: mean_fit([s for s in comparison.scores if s.experiment == name]) for name in names}
    return frozenset(name for name, fit in of.items() if fit >= 100 * settings.followed)


def no_free_run_follows(
    experiments: Collection[str], settings: DiagnosisSettings, lost: Collection[str] = ()
) -> tuple[str, ...]:
    """What the reader of a verdict has to know of experiments that no free run follows, in a sentence for each."""
    return tuple(
        f"{name}: the free runs with the effects and without them both end farther from the measurement than a constant is, as the machine "
        "falls away from an equilibrium. Neither counts: windows, whose start states are estimated, judge."
        if name in lost
        else f"{name}: with the effects the free run is worse. It does not count: a second free run, whose start differs by less than the "
        f"sensors show, departs from the first by {100 * settings.least_parted:.0f} % of its error or more, so that no free run follows "
        "this experiment."
        for name in sorted(experiments)
    )


def _parted(
    problem: Problem, simulator: Simulator, experiment: int, floors: np.ndarray, settings: DiagnosisSettings
) -> float:
    """How far a change of the start state that sensors do not show moves the outputs of one experiment, at most, in units of its error.

    From a change so small that the runs beside one another part in proportion to it.
    """
    runs = _beside(problem, simulator, experiment, settings)
    larger = _unseen(problem.records.y[:, problem.records.span(experiment)], floors, settings) / settings.unseen_start
    return larger * max(runs.grown, default=0.0) if runs.finite and runs.near else 0.0


@np.errstate(divide="ignore", invalid="ignore")
def _unseen(y: np.ndarray, floors: np.ndarray, settings: DiagnosisSettings) -> float:
    """Change of a start state that no sensor shows, as a share of the state's travel: what the noise of the best sensor leaves unknown of
    a value that the first tenth of an experiment tells, and never less than ``settings.unseen_start``.

    Args:
        y: outputs (n_y, N) of the experiment.
        floors: variance of their noise (n_y,).
    """
    known = np.isfinite(y).sum(axis=1)
    shares = [
        np.sqrt(floor / (FRACTION * n)) / np.nanstd(row) for row, floor, n in zip(y, floors, known, strict=True) if n
    ]
    return max(settings.unseen_start, min((float(s) for s in shares if np.isfinite(s)), default=0.0))


@dataclass(frozen=True)
class _Beside:
    """A free run and those that begin next to it: whether it is finite, and nearer to the measurement than a constant is; how far those
    part from it whose distance grows, in units of its error."""

    finite: bool
    near: bool
    grown: tuple[float, ...]


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def _beside(problem: Problem, simulator: Simulator, experiment: int, settings: DiagnosisSettings) -> _Beside:
    """The free run of one experiment and those beside it."""
    records, length = problem.records, int(problem.records.lengths[experiment])

    def runs(starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first, last = (np.repeat(ends[experiment], len(starts)) for ends in (records.first, records.last))
        asked = Pass(Windows(first, last, length), problem.values, starts, keep_states=True)
        run = simulator.run(problem.driving_records, asked)
        assert run.states is not None
        return run.y[:, :length], run.states[:, :length]

    start, measured = problem.initial[experiment : experiment + 1], records.y[:, records.span(experiment)].T
    along, states = runs(start)
    error, spread = (_size(problem.weights * e) for e in (along[0] - measured, measured - np.nanmean(measured, axis=0)))
    if not np.isfinite(states[0]).all():
        return _Beside(False, False, ())
    beside, _ = runs(start + np.diag(settings.unseen_start * np.ptp(states[0], axis=0)))
    moved = problem.weights * (beside - along)
    shares = tuple(_size(m) / max(error, 1e-300) for m in moved if _grew(m) >= settings.least_growth)
    return _Beside(True, bool(error <= spread), shares)


def _grew(moved: np.ndarray) -> float:
    """How many times as large a change (N, n_y) is over the record as over its first tenth."""
    early = _size(moved[: max(1, int(np.ceil(FRACTION * len(moved))))])
    return _size(moved) / early if early > 0 else 0.0


def _size(values: np.ndarray) -> float:
    """Root mean square of those that are known; infinite where one overflows."""
    return float("inf") if np.isinf(values).any() else float(np.sqrt(np.nanmean(values**2)))
