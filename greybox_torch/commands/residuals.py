"""`greybox residuals`: prediction errors, whether they are white, and whether the inputs still explain part of them."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.residuals import residuals
from greybox_torch.api.simulate import START
from greybox_torch.checkpoint import checkpoint_name
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import load_task
from greybox_torch.restored import load_beside


def run(dataset: Path, checkpoint: Path | None, options: Options) -> None:
    """Tests the errors of the free run with the start values, or with the model of a checkpoint; writes their figure."""
    task = load_task(dataset, options)
    model, data, name = task.model, task.data, START
    if checkpoint is not None:
        model, data = load_beside(checkpoint, task.model, task.data)
        name = checkpoint_name(checkpoint)
    options.finish(residuals(model, data, name=name, device=task.device, precision=task.precision), task.folder)
