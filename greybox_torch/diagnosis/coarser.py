"""Recordings searched with fewer samples: sampling as the model needs it, not as the logger had it.

A search costs as much as there are samples. One of several of them shows as much of a law where neither the machine nor the model does
anything between, or next to nothing beside what the model leaves, and a step of the simulation may be that much longer. What is found is
fitted to all samples and judged by them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.diagnosis.hypothesis.noise import floor_known, output_floors
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.simulation.simulator import Simulator


@dataclass(frozen=True)
class Coarser:
    """A data set with its estimation problem, of every so many samples or as it was, and what a reader has to know of it."""

    dataset: DataSet
    problem: Problem
    sentences: tuple[str, ...] = ()


def coarser(
    dataset: DataSet,
    problem: Problem,
    simulator: Simulator,
    problem_of: Callable[[DataSet], Problem],
    settings: DiagnosisSettings,
    budget: SearchBudget,
    left: Callable[[], np.ndarray] | None = None,
) -> Coarser:
    """``dataset`` with as few samples as still show nothing but noise between them, and need no more sub-steps; as it is where all do.

    Args:
        problem: of the estimation experiments of ``dataset``.
        simulator: with the sub-steps that ``problem`` needs.
        problem_of: makes such a problem of a data set.
        left: simulates the mean squared errors (n_y,) of the model as it stands, in output units. With them, motion may be between the
            samples as well that is a small part of these (``between_samples``); without, where the recordings do not tell their noise all
            samples are kept.
    """
    most = min(budget.most_passed_over + 1, _fewest(dataset) // budget.least_samples)
    slower = any(r.between for r in dataset.recordings)  # what is measured may not be among the samples kept
    if most < 2 or slower or (left is None and not floor_known(problem, settings)):
        return Coarser(dataset, problem)
    beside = np.zeros(len(problem.weights)) if left is None else settings.between_samples * left()
    between = "nothing but noise is" if left is None else "next to nothing of what the model leaves is"
    inputs = [i.name for i in problem.model.inputs]
    for every in range(most, 1, -1):
        found = sampled(dataset, every, inputs)
        there = problem_of(found)
        if _as_quiet(problem, there, settings, beside) and fine_enough(simulator, there).substeps <= simulator.substeps:
            step = found.recordings[0].sample_time
            told = (
                f"The search used one of {every} samples, {step:.4g} s apart: {between} between them. "
                "The final fits and the free runs are of all samples."
            )
            return Coarser(found, there, (told,))
    return Coarser(dataset, problem)


def sampled(dataset: DataSet, every: int, inputs: Collection[str]) -> DataSet:
    """``dataset`` with one of ``every`` samples, the first among them; what is left at the end is dropped.

    Of ``inputs`` that are held between samples it is the mean until the next.
    """

    def of(recording: Recording) -> Recording:
        count = len(recording) // every
        held = np.append(np.diff(recording.time), recording.sample_time)[: count * every].reshape(count, every)
        parts = held / held.sum(axis=1, keepdims=True)
        signals = {
            name: (values[: count * every].reshape(count, every) * parts).sum(axis=1)
            if name in inputs and dataset.hold == "zoh"
            else values[: count * every : every]
            for name, values in recording.signals.items()
        }
        time = recording.time[: count * every : every]
        return replace(recording, time=time, sample_time=every * recording.sample_time, signals=signals)

    return replace(dataset, recordings=tuple(of(r) for r in dataset.recordings))


def _fewest(dataset: DataSet) -> int:
    """The samples of the role that has fewest."""
    roles = {r.role for r in dataset.recordings}
    return min(sum(len(r) for r in dataset.recordings if r.role == role) for role in roles)


def _as_quiet(fine: Problem, coarse: Problem, settings: DiagnosisSettings, beside: np.ndarray) -> bool:
    """Whether the outputs look as quiet with fewer samples, but for ``beside`` (n_y,) of their squares: fast motion looks like noise."""
    before, after = (output_floors(p, settings) for p in (fine, coarse))
    most = settings.noise_floors_agree * before + beside
    known = np.isfinite(before) & np.isfinite(after)
    return bool((after[known] <= most[known]).all())
