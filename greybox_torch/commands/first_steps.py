"""How the commands of the first steps are written on the command line: `demo`, `new`, `card`, `check`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from greybox_torch.commands.option_types import Device, Json, Model, Pdf, Seed, Settings
from greybox_torch.commands.options import Options
from greybox_torch.commands.seconds import seconds


def declare(app: typer.Typer) -> None:
    """Enter the commands into `app`."""
    for command in (demo, new, card, check):
        app.command()(command)


def demo(
    settings: Settings = None,
    model: Model = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where to write results.", show_default="results/demo")
    ] = None,
    seed: Seed = 0,
    device: Device = "cpu",
    pdf: Pdf = False,
    json: Json = False,
) -> None:
    """Diagnose a small simulated arm with one concealed effect, which comes with the package."""
    from greybox_torch.commands import demo

    demo.run(Options(model, out, seed, device, json), settings, pdf=pdf)


def new(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of the file, such as my_motor; the class is then MyMotor.")
    ],
    like: Annotated[
        str,
        typer.Option(metavar="motor|pendulum|two_mass|tank|thermal", help="The machine that is most like yours."),
    ] = "motor",
    out: Annotated[Path | None, typer.Option(metavar="FILE.py", help="Where to write.", show_default="NAME.py")] = None,
    json: Json = False,
) -> None:
    """Write a commented model file to change into one's own."""
    from greybox_torch.commands import new

    new.run(name, like, Options(out=out, json=json))


def card(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...", help="Recordings; the last of several, or the last quarter of one, is for validation."
        ),
    ],
    model: Model = None,
    sample_time: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            parser=seconds("sample_time"),
            help="Sample time, where no column has time stamps.",
            show_default="guessed",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="CARD.toml", help="Where to write.", show_default="dataset.toml beside FILE")
    ] = None,
    json: Json = False,
) -> None:
    """Look at recordings and write a commented data card for them."""
    from greybox_torch.commands import card

    card.run(files, sample_time, Options(model, out, json=json))


def check(
    target: Annotated[
        str, typer.Argument(metavar="MODEL.py:CLASS|DATASET.toml", help="The model, or a data card that names it.")
    ],
    model: Model = None,
    json: Json = False,
) -> None:
    """Say what is wrong with a model before any data: names, code, units, and what moves nothing."""
    from greybox_torch.commands import check

    check.run(target, Options(model, json=json))
