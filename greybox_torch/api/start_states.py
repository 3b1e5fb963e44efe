"""What free runs begin with, and models whose fits with their own start states were far better."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from greybox_torch.api.free_runs import Runs
from greybox_torch.checkpoint import Checkpoint, load_checkpoint
from greybox_torch.data import DataSet

FIRST_TENTH = (
    "Each experiment is begun with start states estimated on its first tenth; `greybox fit` and `greybox diagnose` have those of their "
    "estimate, so that their fits may differ."
)
LESS = 10.0
"""Points of % by which a fit has to be worse than with the model's own start states to be told."""

Fits = Mapping[tuple[str, str], float]
"""In %, by experiment and output."""


def begun_with(runs: Runs) -> list[str]:
    """How free runs begin, where that is estimated: a sentence, or none."""
    return [FIRST_TENTH] if any(run.problem.initial_free.any() for run in runs.values()) else []


def own_fits(given: Any, data: DataSet) -> Fits:
    """The fits that a checkpoint, by path, or a result has of the same recordings; empty of a model, and of other recordings."""
    if isinstance(given, str | PathLike):
        return _saved(load_checkpoint(Path(given)), data)
    rows: Sequence[Mapping[str, Any]] = getattr(given, "scores", ()) if getattr(given, "data", None) is data else ()
    last = rows[-1]["model"] if rows else ""
    return {(row["experiment"], row["output"]): row["fit"] for row in rows if row["model"] == last}


def _saved(checkpoint: Checkpoint, data: DataSet) -> Fits:
    if checkpoint.dataset != data.sha256:
        return {}
    fits = {}
    for row in checkpoint.figures:
        models = [
            name for name, figures in row.items() if isinstance(figures, Mapping) and figures.get("fit") is not None
        ]
        if models:
            fits[row["experiment"], row["output"]] = float(row[models[-1]]["fit"])
    return fits


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
            more = f" (and {len(worse) - 1} more rows)" if len(worse) > 1 else ""
            told.append(
                f"{name}: {output} of '{experiment}' has a fit of {fit:.1f} %, and of {fits[experiment, output]:.1f} % with the start "
                f"states of its estimate{more}: the first tenth does not determine them. Fix what is known in [model.initial], or judge by "
                "what the model was estimated with"
            )
    return told
