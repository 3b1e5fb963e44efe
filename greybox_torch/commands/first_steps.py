"""How the commands of the first steps are written on the command line: `check`."""

from __future__ import annotations

from typing import Annotated

import typer

from greybox_torch.commands.option_types import Json, Model
from greybox_torch.commands.options import Options


def declare(app: typer.Typer) -> None:
    """Enter the commands into `app`."""
    app.command()(check)


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
