"""How the commands of the first steps are written on the command line: `card`, `check`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from greybox_torch.commands.option_types import Json, Model
from greybox_torch.commands.options import Options


def declare(app: typer.Typer) -> None:
    """Enter the commands into `app`."""
    for command in (card, check):
        app.command()(command)


def card(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Recordings; the last one is for validation.")],
    model: Model = None,
    sample_time: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="Where no column has time stamps.", show_default="guessed")
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
