"""How a card says of one of several files what its time stamps are: `clocks` of an experiment, for messages and drafts."""

from __future__ import annotations

from greybox_torch.files import toml_key, toml_text


def clock_written(file: str, **keys: str | float | None) -> str:
    """The entry of a file, as the experiment names it; of the ``keys`` those that are not None."""
    given = [
        f"{key} = {toml_text(value) if isinstance(value, str) else f'{value:.12g}'}"
        for key, value in keys.items()
        if value is not None
    ]
    return f"{toml_key(file)} = {{ {', '.join(given)} }}"


def in_clocks(file: str, **keys: str | float | None) -> str:
    """What to write of a file, for messages."""
    return f"clocks = {{ {clock_written(file, **keys)} }} in that [[experiment]]"
