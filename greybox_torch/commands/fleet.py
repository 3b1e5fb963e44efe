"""`greybox fleet`: every data set below a folder, on Dask, and one page for all."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from greybox_torch.api.fleet import fleet
from greybox_torch.api.fleet_result import FleetResult
from greybox_torch.commands.fleet_progress import counting
from greybox_torch.commands.options import Options
from greybox_torch.commands.results_folder import check_folder

OUT = Path("results/fleet")


def run(
    places: Sequence[str],
    options: Options,
    *,
    time_limit: float | None = None,
    settings: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
) -> None:
    """Diagnoses what is found, writes results as they come, and prints the table.

    Raises:
        KeyboardInterrupt: the user stopped it; what is done is written and printed by then.
    """
    folder = options.out or OUT
    check_folder(folder)
    with counting(f"diagnosing {', '.join(places)}") as progress:
        found = fleet(
            places,
            folder,
            model=options.model,
            settings=settings,
            time_limit=time_limit,
            seed=options.seed,
            device=options.device,
            workers=workers,
            scheduler=scheduler,
            progress=progress,
        )
    _finish(found, options, folder)
    if not found.complete:
        raise KeyboardInterrupt


def _finish(found: FleetResult, options: Options, folder: Path) -> None:
    console = options.console()
    found.show(console)
    options.print_written(console, folder, [path.name for path in found.files(folder)])
    options.print_json(found.to_json(folder))
