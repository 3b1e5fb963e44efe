"""`greybox simulate`: free-run simulation with the start values, or with the model of a checkpoint."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.simulate import simulate
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import load_task, simulated_by


def run(dataset: Path, checkpoint: Path | None, options: Options) -> None:
    """Simulates every experiment; writes the outputs and a figure of each."""
    task = load_task(dataset, options)
    model, data, name = simulated_by(task, checkpoint)
    options.finish(simulate(model, data, name=name, device=task.device, precision=task.precision), task.folder)
