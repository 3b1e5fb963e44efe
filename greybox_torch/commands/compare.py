"""`greybox compare`: simulated against measured, for the start values and any number of checkpoints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.text import Text

from greybox_torch.checkpoint import checkpoint_name
from greybox_torch.commands.free_runs import (
    START,
    free_run,
    print_overflows,
    print_scores,
    print_substeps,
    result_json,
    write_figures,
)
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import load_task


def run(dataset: Path, checkpoints: Sequence[Path], options: Options) -> None:
    """Prints fit and error of every model on every experiment, and writes a figure of each experiment.

    A model whose simulation overflows is reported so, beside the others. Raises UserError where the input is at fault.
    """
    task = load_task(dataset, options)
    runs = [free_run(task)]
    runs += [free_run(task, path, name) for path, name in zip(checkpoints, _names(checkpoints), strict=True)]
    figures = write_figures(task, runs, "comparison")
    console = options.console()
    console.print(Text(task.data.name, style="bold"))
    print_scores(console, task.data, {run.name: run.comparison.scores for run in runs})
    print_overflows(console, runs)
    for run in runs:
        print_substeps(console, run.substeps, run.name)
    console.print(Text(f"Written to {task.folder}: {', '.join(path.name for path in figures)}"), soft_wrap=True)
    options.print_json({**result_json(task.data, runs), "figures": [str(path) for path in figures]})


def _names(checkpoints: Sequence[Path]) -> list[str]:
    """The checkpoints' file names; the whole path where that alone would not tell them apart, numbered where it is given twice."""
    names: list[str] = []
    stems = [START, *[checkpoint_name(path) for path in checkpoints]]
    for path, stem in zip(checkpoints, stems[1:], strict=True):
        name = stem if stems.count(stem) == 1 else str(path)
        again = sum(other == name or other.startswith(f"{name} (") for other in names)
        names.append(f"{name} ({again + 1})" if again else name)
    return names
