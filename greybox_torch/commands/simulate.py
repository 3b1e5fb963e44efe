"""`greybox simulate`: free-run simulation with the start values."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import numpy as np
from rich.text import Text

from greybox_torch.commands.free_runs import (
    ModelRun,
    file_stems,
    free_run,
    print_scores,
    print_substeps,
    refuse_overflow,
    result_json,
    write_figures,
)
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import Task, load_task
from greybox_torch.files import replacing


def run(dataset: Path, options: Options) -> None:
    """Simulates every experiment from start states estimated on its first tenth; writes the outputs and a figure of each.

    Raises UserError where the input is at fault, NumericalError where the simulation overflows.
    """
    task = load_task(dataset, options)
    simulated = free_run(task)
    refuse_overflow(task, simulated)
    tables = _write_tables(task, simulated)
    figures = write_figures(task, [simulated], "simulated")
    console = options.console()
    console.print(Text(f"{task.data.name}: {task.model.title} with its start values", style="bold"))
    print_scores(console, task.data, {simulated.name: simulated.comparison.scores})
    print_substeps(console, simulated.substeps)
    console.print(Text(f"Written to {task.folder}: {', '.join(p.name for p in (*tables, *figures))}"), soft_wrap=True)
    paths = {"tables": [str(path) for path in tables], "figures": [str(path) for path in figures]}
    options.print_json({**result_json(task.data, [simulated]), **paths})


def _write_tables(task: Task, simulated: ModelRun) -> list[Path]:
    """A CSV file an experiment: time, and every output measured and simulated."""
    names = [output.name for output in task.model.outputs]
    header = ",".join(["time", *[f"{name}_{what}" for name in names for what in ("measured", "simulated")]])
    paths = [task.folder / f"{stem}.csv" for stem in file_stems(task.data, "simulated")]
    with ExitStack() as together:
        for path, recording, values in zip(paths, task.data.recordings, simulated.comparison.simulated, strict=True):
            columns = [recording.time]
            for k, name in enumerate(names):
                columns += [recording.signals[name], values[:, k]]
            temporary = together.enter_context(replacing(path))
            np.savetxt(temporary, np.column_stack(columns), fmt="%.10g", delimiter=",", header=header, comments="")
    return paths
