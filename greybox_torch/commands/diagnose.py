"""`greybox diagnose`: whether physics is missing, where, what it is, and the model with it."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.diagnose import diagnose
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import diagnosing
from greybox_torch.commands.results_folder import nothing_written
from greybox_torch.commands.task import load_task
from greybox_torch.diagnosis.settings import settings_from_file, settings_from_mapping


def run(
    dataset: Path, time_limit: float | None, options: Options, settings: Path | None = None, *, pdf: bool = False
) -> None:
    """Diagnoses, writes the verdict, the report and the augmented model (all or nothing), and prints what was found."""
    task = load_task(dataset, options, writes_model="diagnose")
    own = settings_from_mapping(task.data.diagnosis, task.data.place("[diagnosis]"))
    if settings is not None:
        own = settings_from_mapping(settings_from_file(settings), str(settings), own)
    with nothing_written(), diagnosing(f"diagnosing {task.data.name}") as hear:
        found = diagnose(
            task.model,
            task.data,
            seed=options.seed,
            device=task.device,
            time_limit=time_limit,
            settings=own[0],
            budget=own[1],
            on_progress=task.replacing.before(hear),
        )
    task.replacing.warn()
    options.finish(found, task.folder, found.save(task.folder, pdf=pdf))
