"""`greybox fit`: estimates the free parameters and start states."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from greybox_torch.api.fit import fit
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import estimating
from greybox_torch.commands.results_folder import nothing_written
from greybox_torch.commands.task import load_task
from greybox_torch.restored import load_beside


def run(
    dataset: Path,
    options: Options,
    profiled: Sequence[str] = (),
    starts: int | None = None,
    checkpoint: Path | None = None,
) -> None:
    """Estimates, and writes fit.json, the checkpoint `model`, and figures of the profiles that were asked for.

    Args:
        checkpoint: begins with the model of earlier results, effects included, and their values; with the start values else.
    """
    with nothing_written():
        task = load_task(dataset, options, writes_model="fit")
        model, data = task.model, task.data
        if checkpoint is not None:
            model, data = load_beside(checkpoint, model, data)
        with estimating() as tell:
            found = fit(
                model,
                data,
                starts=starts,
                seed=options.seed,
                profiles=profiled,
                device=task.device,
                precision=task.precision,
                progress=task.replacing.before(tell),
            )
    task.replacing.warn()
    options.finish(found, task.folder)
