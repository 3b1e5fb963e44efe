"""What free runs begin with, and models whose fits with their own start states were far better."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.api.free_runs import Runs
from greybox_torch.checkpoint import load_checkpoint
from greybox_torch.data import DataSet
from greybox_torch.estimate.far_starts import far_starts, told_far
from greybox_torch.estimate.initial import BEGINNINGS
from greybox_torch.name_lists import further

LESS = 10.0
"""Points of % by which a fit has to be worse than with the model's own start states to be told."""

FAR_FROM_MEASURED = 0.1
"""Share of what a sensor shows in an experiment by which a state that it measures has to begin elsewhere to be told: with start values that
are not the machine's, most begin a little off.
"""

Fits = Mapping[tuple[str, str], float]
"""In %, by experiment and output."""


def first_tenth(runs: Runs) -> list[str]:
    """How free runs begin, where that is estimated: a sentence, or none."""
    return [BEGINNINGS] if any(run.problem.initial_free.any() for run in runs.values()) else []


def begun_far(runs: Runs) -> dict[str, str]:
    """By model a sentence, without its full stop, where free runs begin far from the first sample of what is declared to begin as measured.

    The first tenth asks for that start where the model follows nothing from the right one: it is no fault of the column.
    """
    told = {}
    for name, run in runs.items():
        given = [state for state, entry in run.data.initial.items() if entry.value is not None]
        begun = run.problem.with_values(run.problem.values, np.array(run.comparison.initial))
        if far := far_starts(begun, given, share=FAR_FROM_MEASURED):
            told[name] = told_far(far, estimated=False)
    return told


def own_fits(given: Any, data: DataSet) -> Fits:
    """The fits that a checkpoint, by path, or a result has of the same estimation experiments with the start states of its estimate; empty
    of a model, of other recordings, and where those were estimated on the first tenth, as after a training.
    """
    if isinstance(given, str | PathLike):
        checkpoint = load_checkpoint(Path(given))
        own = [row | row[name] for row in checkpoint.figures if (name := checkpoint.own_starts) in row]
        estimated_from = checkpoint.dataset
    elif name := getattr(given, "own_starts", ""):
        own = [row for row in given.scores if row["model"] == name]
        estimated_from = given.data.sha256
    else:
        return {}
    if estimated_from != data.sha256:
        return {}
    return {
        (row["experiment"], row["output"]): float(fit)
        for row in own
        if row["role"] == "estimation" and (fit := row.get("fit")) is not None
    }


def better_before(runs: Runs, own: Mapping[str, Fits]) -> list[str]:
    """A sentence for every model that follows an experiment far worse than with the start states of its estimate."""
    told = []
    for name, run in runs.items():
        fits = own.get(name, {})
        worse = [
            (fits[place] - score.fit, place, score.fit)
            for score in run.comparison.scores
            if (place := (score.experiment, score.output)) in fits and fits[place] - score.fit > LESS
        ]
        if worse:
            _, (experiment, output), fit = max(worse)
            more = f" (and {further(len(worse) - 1, 'row')})" if len(worse) > 1 else ""
            told.append(
                f"{name}: {output} of '{experiment}' has a fit of {fit:.1f} %, and of {fits[experiment, output]:.1f} % with the start "
                f"states of its estimate{more}: the first tenth does not determine them. Fix what is known in [model.initial], or judge by "
                "what the model was estimated with"
            )
    return told
