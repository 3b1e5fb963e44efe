"""Free runs of one or several models on all experiments of a task: what `simulate`, `compare` and `residuals` share."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from greybox_torch.commands.tables import print_table
from greybox_torch.commands.task import Task
from greybox_torch.data import DataSet
from greybox_torch.errors import NumericalError
from greybox_torch.estimate.comparison import Score
from greybox_torch.evaluation import Evaluation, evaluated
from greybox_torch.files import replacing
from greybox_torch.simulation.substeps import LARGEST

START = "start"
"""The name of the model with the card's values."""


@dataclass(frozen=True)
class ModelRun(Evaluation):
    """A model's free runs, with its name in results."""

    name: str = START


def free_run(task: Task, checkpoint: Path | None = None, name: str = START) -> ModelRun:
    """Simulates all experiments with the card's values or those of a checkpoint; start states from the first tenth of each."""
    found = evaluated(task.data, task.model, task.model_name, checkpoint, device=task.device, precision=task.precision)
    return ModelRun(**{field.name: getattr(found, field.name) for field in fields(found)}, name=name)


def refuse_overflow(task: Task, run: ModelRun) -> None:
    """Raises NumericalError, saying where, if a free run is not finite."""
    if run.overflow is not None:
        raise NumericalError(f"simulating {task.model.title}: {run.overflow}")


def print_substeps(console: Console, substeps: int, name: str = "") -> None:
    """Says so where a sample takes more than one step of the integration."""
    if substeps > 1:
        of = f" of {name}" if name else ""
        doubt = ", which may still be too few" if substeps == LARGEST else ""
        console.print(
            Text(
                f"Each sample{of} is simulated in {substeps} Runge-Kutta steps{doubt}: the motion is fast for the sample time."
            ),
            soft_wrap=True,
        )


def print_overflows(console: Console, runs: Sequence[ModelRun]) -> None:
    """Says of every model whose simulation overflows where that is, and what avoids it."""
    for run in runs:
        if run.overflow is not None:
            console.print(Text(f"{run.name}: {run.overflow}", style="yellow"), soft_wrap=True)


def scores_json(scores: Sequence[Score]) -> list[dict[str, Any]]:
    """Rows as the contract wants them."""
    return [
        {"experiment": s.experiment, "role": s.role, "output": s.output, "fit": s.fit, "rmse": s.rmse} for s in scores
    ]


def result_json(data: DataSet, runs: Sequence[ModelRun]) -> dict[str, Any]:
    """The result of `simulate` and `compare`."""
    models = [
        {
            "name": r.name,
            "model": r.model_name,
            "fit": scores_json(r.comparison.scores),
            "substeps": r.substeps,
            "overflow": r.overflow,
        }
        for r in runs
    ]
    return {
        "schema": "greybox-compare/1",
        "dataset": data.name,
        "held_out_by_default": data.held_out_by_default,
        "models": models,
    }


def print_scores(console: Console, data: DataSet, scores: dict[str, Sequence[Score]]) -> None:
    """A line for every output of every experiment, with the fit and the error of each model."""
    columns = [
        "experiment",
        "role",
        "output",
        *[f"{name}\n{what}" for name in scores for what in ("fit [%]", "rmse")],
        "unit",
    ]
    rows = []
    for together in zip(*scores.values(), strict=True):
        first = together[0]
        numbers = [cell for score in together for cell in _cells(score)]
        rows.append([first.experiment, first.role, first.output, *numbers, data.channels[first.output].unit])
    print_table(console, columns, rows, prose=["experiment"])
    if data.held_out_by_default:
        note = 'The card gives no experiment the role "validation": the last quarter of each is held out.\n'
        console.print(note, soft_wrap=True)


def _cells(score: Score) -> tuple[str | float, str | float]:
    return (score.fit, score.rmse) if np.isfinite(score.rmse) else ("overflow", "overflow")


def write_figures(task: Task, runs: Sequence[ModelRun], prefix: str) -> list[Path]:
    """Draws every experiment, simulated against measured; all of the figures are written, or none."""
    from greybox_torch.report.comparison import plot_comparison

    outputs = [task.data.channels[output.name] for output in task.model.outputs]
    paths = [task.folder / f"{stem}.png" for stem in file_stems(task.data, prefix)]
    with ExitStack() as together:
        for e, (recording, path) in enumerate(zip(task.data.recordings, paths, strict=True)):
            scores = {r.name: [s.fit for s in r.comparison.scores if s.experiment == recording.name] for r in runs}
            legend = {name: f"{name} ({', '.join(f'{fit:.1f} %' for fit in fits)})" for name, fits in scores.items()}
            figure = plot_comparison(recording, outputs, {r.name: r.comparison.simulated[e] for r in runs}, legend)
            figure.savefig(together.enter_context(replacing(path)))
    return paths


def file_stems(data: DataSet, prefix: str) -> list[str]:
    """A file name for every experiment: its number and what of its name is safe in a file name."""
    plain = ["".join(c if c.isalnum() else "_" for c in recording.name.lower())[:40] for recording in data.recordings]
    return [f"{prefix}_{number}_{name}" for number, name in enumerate(plain, start=1)]
