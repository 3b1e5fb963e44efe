"""Free runs of one or several models on all experiments of a data set, as JSON and as figures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from greybox_torch.api.arguments import check_experiment
from greybox_torch.api.scores import Scores, scores_json
from greybox_torch.data import DataSet, Recording
from greybox_torch.evaluation import Evaluation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Runs = Mapping[str, Evaluation]
"""By the models' names, all on the same experiments."""

MOST_EXPERIMENTS = 4
"""How many experiments one figure shows where none is asked for; validation comes first."""


def free_runs_json(data: DataSet, runs: Runs) -> dict[str, Any]:
    """What `simulate` and `compare` tell of them."""
    models = [
        {
            "name": name,
            "model": run.model_name,
            "fit": scores_json(run.comparison.scores),
            "substeps": run.substeps,
            "overflow": run.overflow,
            "initial": run.initial,
        }
        for name, run in runs.items()
    ]
    return {
        "schema": "greybox-compare/1",
        "dataset": data.name,
        "held_out_by_default": data.held_out_by_default,
        "models": models,
    }


def file_stems(data: DataSet, prefix: str) -> list[str]:
    """A file name for every experiment: its number and what of its name is safe in a file name."""
    plain = ["".join(c if c.isalnum() else "_" for c in recording.name.lower())[:40] for recording in data.recordings]
    return [f"{prefix}_{number}_{name}" for number, name in enumerate(plain, start=1)]


def figure_files(folder: Path, data: DataSet, runs: Runs, prefix: str) -> dict[Path, str | bytes]:
    """A picture of every experiment, simulated against measured."""
    from greybox_torch.report.notebook import png

    stems = zip(file_stems(data, prefix), data.recordings, strict=True)
    return {folder / f"{stem}.png": png(plot_free_runs(data, runs, recording.name)) for stem, recording in stems}


def plot_free_runs(data: DataSet, runs: Runs, experiment: str | None = None) -> Figure:
    """The figure of one experiment, or of the first few of them.

    Raises:
        ArgumentError: there is no such experiment.
    """
    simulated = {name: run.simulated for name, run in runs.items()}
    return plot_simulated(data, simulated, {name: run.comparison.scores for name, run in runs.items()}, experiment)


def plot_simulated(
    data: DataSet, simulated: Mapping[str, Mapping[str, np.ndarray]], scores: Scores, experiment: str | None = None
) -> Figure:
    """:func:`plot_free_runs` of what is ``simulated`` (N, n_y) by model and experiment."""
    from greybox_torch.report.comparison import plot_comparisons  # matplotlib takes half a second
    from greybox_torch.report.text import fit as shown

    panels = []
    for recording in _shown(data, experiment):
        fits = {name: [s.fit for s in own if s.experiment == recording.name] for name, own in scores.items()}
        legend = {name: f"{name} ({', '.join(shown(fit) for fit in own)})" for name, own in fits.items()}
        panels.append((recording, {name: own[recording.name] for name, own in simulated.items()}, legend))
    outputs = dict.fromkeys(score.output for score in next(iter(scores.values())))
    return plot_comparisons(panels, [data.channels[output] for output in outputs])


def _shown(data: DataSet, experiment: str | None) -> list[Recording]:
    """The experiment asked for; otherwise the first few, validation before estimation, in the order of the data set."""
    if experiment is not None:
        check_experiment(data, experiment)
    ranked = sorted(data.recordings, key=lambda r: r.role != "validation")
    wanted = [experiment] if experiment is not None else [r.name for r in ranked[:MOST_EXPERIMENTS]]
    return [recording for recording in data.recordings if recording.name in wanted]
