"""`greybox check`: what is wrong with a model, before any data."""

from __future__ import annotations

from pathlib import Path

import typer

from greybox_torch.api.check import check
from greybox_torch.commands.options import Options
from greybox_torch.data import load_dataset
from greybox_torch.data.readers import READERS
from greybox_torch.errors import UserError
from greybox_torch.systems import BUILT_IN


def run(target: str, options: Options) -> None:
    """Prints the findings; ends with 2 where the model, or the card, cannot be used.

    Args:
        target: a model's name, or a data card that names one.
    """
    path = Path(target)
    of_no_model = path.is_dir() or (
        path.suffix.lower() in READERS and path.is_file()
    )  # what to write is said of a card
    is_card = target.endswith(".toml") or (target not in BUILT_IN and of_no_model)
    data = load_dataset(path) if is_card else None
    name = options.model or (target if data is None else data.model)
    if name is None:
        raise UserError(
            f"{target}: [model] name is missing and no --model is given; expected a file and class such as my_motor.py:Motor"
        )
    found = check(name, data)
    found.show(options.console())
    options.print_json(found.to_json())
    if not found.usable:
        raise typer.Exit(2)
