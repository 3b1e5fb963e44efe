"""How the commands that go on from the results of a diagnosis are written on the command line: `design`, `export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from greybox_torch.commands.option_types import Json, Model, Seed
from greybox_torch.commands.options import Options
from greybox_torch.commands.seconds import seconds as in_seconds


def declare(app: typer.Typer) -> None:
    """Enter the commands into `app`."""
    for command in (design, export):
        app.command()(command)


def design(
    results: Annotated[Path, typer.Argument(metavar="RESULTS", help="The folder that greybox diagnose has written.")],
    precision: Annotated[
        str | None,
        typer.Option(
            metavar="PARAMETER",
            help="A parameter's name: shrink its standard deviation instead. Not that of numbers, as in fit and simulate.",
        ),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", parser=in_seconds("seconds"), help="How long the recording may be."),
    ] = None,
    model: Model = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where to write the design.", show_default="RESULTS/design")
    ] = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Design the next recording: the input that tells the leading hypotheses apart, within the limits on the card."""
    from greybox_torch.commands import design

    design.run(results, precision, seconds, Options(model, out, seed, json=json))


def export(
    results: Annotated[
        Path, typer.Argument(metavar="RESULTS", help="Folder of fit, train or diagnose, or a checkpoint.")
    ],
    to: Annotated[str, typer.Option(metavar="c|torch|fmu|mjcf|urdf", help="What to export to.")],
    dataset: Annotated[
        Path | None,
        typer.Option(
            metavar="DATASET.toml", help="Card that names the model; its recordings set the integration step."
        ),
    ] = None,
    model: Model = None,
    name: Annotated[
        str | None, typer.Option(metavar="NAME", help="Name of functions and files.", show_default="the model's")
    ] = None,
    step: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS", parser=in_seconds("step"), help="Largest integration step.", show_default="as needed"
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where to write.", show_default="beside the checkpoint")
    ] = None,
    json: Json = False,
) -> None:
    """Write the model with its effects as C, a module of torch or an FMU; or the effects alone, in MJCF or URDF."""
    from greybox_torch.commands import export

    export.run(results, to, dataset, name, step, Options(model, out, json=json))
