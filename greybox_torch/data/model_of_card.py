"""The model that a card names."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.files import absolute


def absolute_model(name: str | None, path: Path) -> str | None:
    """ "my_motor.py:Motor" with the file relative to the card made absolute; the name of a built-in system as it is."""
    if name is None:
        return None
    file, colon, model_class = name.rpartition(":")
    if not file.endswith(".py"):
        return name
    return f"{absolute((path.parent / file).parent) / Path(file).name}{colon}{model_class}"
