"""`greybox simulate`: free-run simulation with the start values."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.simulate import simulate
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import load_task


def run(dataset: Path, options: Options) -> None:
    """Simulates every experiment; writes the outputs and a figure of each."""
    task = load_task(dataset, options)
    options.finish(simulate(task.model, task.data, device=task.device, precision=task.precision), task.folder)
