"""How the command on many machines is written on the command line: `fleet`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from greybox_torch.commands.option_types import Device, Json, Model, Seed, Settings
from greybox_torch.commands.options import Options
from greybox_torch.commands.seconds import seconds


def declare(app: typer.Typer) -> None:
    """Enter the command into `app`."""
    app.command()(fleet)


def fleet(
    places: Annotated[
        list[str],
        typer.Argument(metavar="FOLDER|GLOB", help="Every dataset.toml below it, or the cards that match. Repeatable."),
    ],
    time_limit: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            parser=seconds("time_limit"),
            help="After this time the best answer so far is given, for each data set.",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Processes on this machine.", show_default="one for each core"),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="tcp://HOST:PORT",
            help="Use the workers of this Dask scheduler instead; they have to see the same files.",
        ),
    ] = None,
    settings: Settings = None,
    model: Model = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where to write results.", show_default="results/fleet")
    ] = None,
    seed: Seed = 0,
    device: Device = "cpu",
    json: Json = False,
) -> None:
    """Diagnose many machines side by side, and put them on one page. What is done and unchanged is kept."""
    from greybox_torch.commands import fleet

    options = Options(model, out, seed, device, json)
    fleet.run(places, options, time_limit=time_limit, settings=settings, workers=workers, scheduler=scheduler)
