"""`greybox fit`: estimates the free parameters and start states."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.text import Text

from greybox_torch.api.fit import fit
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import load_task


def run(dataset: Path, options: Options, profiled: Sequence[str] = (), starts: int | None = None) -> None:
    """Estimates, and writes fit.json, the checkpoint `model`, and figures of the profiles that were asked for."""
    task = load_task(dataset, options, writes_model="fit")
    log = Console(stderr=True, highlight=False)
    found = fit(
        task.model,
        task.data,
        starts=starts,
        seed=options.seed,
        profiles=profiled,
        device=task.device,
        precision=task.precision,
        progress=lambda line: log.print(Text(line), soft_wrap=True),
    )
    options.finish(found, task.folder)
