"""`greybox design`: the next recording, from what a diagnosis has left open."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.api.design import design
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import stages
from greybox_torch.commands.results_folder import check_folder, nothing_written
from greybox_torch.errors import UserError

FOLDER = "design"


def run(results: Path, precision: str | None, seconds: float | None, options: Options) -> None:
    """Designs the input, writes it with a figure and a card (all or nothing), and prints what it is expected to tell."""
    if not results.is_dir():
        what = "is a file" if results.is_file() else "no such folder"
        raise UserError(f"{results}: {what}; expected the folder of results of greybox diagnose")
    folder = options.out if options.out is not None else results / FOLDER
    check_folder(folder)
    with nothing_written(), stages("designing the next recording") as progress:
        found = design(
            results, precision=precision, seconds=seconds, model=options.model, seed=options.seed, progress=progress
        )
    options.finish(found, folder)
