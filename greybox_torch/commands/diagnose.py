"""`greybox diagnose`: whether physics is missing, where, what it is, and the model with it."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.diagnose import diagnose
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import stages
from greybox_torch.commands.task import load_task


def run(dataset: Path, time_limit: float | None, options: Options) -> None:
    """Diagnoses, writes the verdict, the report and the augmented model (all or nothing), and prints what was found."""
    task = load_task(dataset, options)
    with stages(f"diagnosing {task.data.name}") as progress:
        found = diagnose(
            task.model, task.data, seed=options.seed, device=task.device, time_limit=time_limit, progress=progress
        )
    options.finish(found, task.folder)
