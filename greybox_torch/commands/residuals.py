"""`greybox residuals`: prediction errors, whether they are white, and whether the inputs still explain part of them."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.residuals import residuals
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import load_task, simulated_by


def run(dataset: Path, checkpoint: Path | None, options: Options) -> None:
    """Tests the errors of the free run with the start values, or with the model of a checkpoint; writes their figure."""
    task = load_task(dataset, options)
    model, data, name = simulated_by(task, checkpoint)
    options.finish(residuals(model, data, name=name, device=task.device, precision=task.precision), task.folder)
