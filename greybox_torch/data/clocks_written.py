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
    return _in_that_experiment(clock_written(file, **keys))


def in_clocks_to_fill_in(file: str, *keys: str) -> str:
    """The same with the values of the ``keys`` left to the reader."""
    blank = [f"{key} = …" if key == "offset" else f'{key} = "…"' for key in keys]
    return _in_that_experiment(f"{toml_key(file)} = {{ {', '.join(blank)} }}")


def _in_that_experiment(entry: str) -> str:
    return f"clocks = {{ {entry} }} in that [[experiment]]"
